// SPDX-License-Identifier: Apache-2.0
// `overtone config` as an operator types it, and a server that is told by file, environment and
// flags.
#include <sys/stat.h>

#include <fstream>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/client/cli/child_process.h"
#include "overtone/client/cli/server_process.h"
#include "overtone/tests/support/temporary_directory.h"

namespace overtone {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;

constexpr absl::Duration kPatience = absl::Seconds(60);

class ConfigurationTest : public ::testing::Test {
 protected:
  std::string Path(const std::string& name) { return folder_.File(name); }

  std::string Write(const std::string& text) {
    std::ofstream(Path("server.yaml")) << text;
    return Path("server.yaml");
  }

  // All that the command prints, and how it ends.
  std::string Run(const std::vector<std::string>& arguments) {
    const std::string log = Path("stderr.txt");
    std::ofstream(log, std::ios::trunc).flush();
    auto child = ChildProcess::Start({"it", arguments, log});
    if (!child.ok()) return child.status().ToString();
    std::string text;
    for (;;) {
      const auto line = (*child)->ReadLine(kPatience, [] { return absl::OkStatus(); });
      if (!line.ok()) {
        std::stringstream errors;
        errors << std::ifstream(log).rdbuf();
        return text + errors.str() + std::string(line.status().message());
      }
      text += *line + "\n";
    }
  }
  std::string Overtone(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {OVERTONE_PROGRAM, "config"});
    return Run(arguments);
  }

  const TemporaryDirectory folder_;
};

TEST_F(ConfigurationTest, CheckNamesEveryMistakeWithItsLine) {
  const std::string file =
      Write("listen: localhost:7077\nquotas:\n  max_stream: 3\nlog_level: loud\n");
  EXPECT_THAT(Overtone({"check", file}),
              HasSubstr(file + ":3: unknown key 'quotas.max_stream'; did you mean "
                               "'quotas.max_streams'?\n"));
  EXPECT_THAT(Overtone({"check", file}), HasSubstr("ended with exit code 2"));
  Write("quotas:\n  max_streams: 3\nlog_level: loud\n");
  EXPECT_THAT(Overtone({"check", file}), HasSubstr(file + ":3: log_level: 'loud' is none of"));
  Write("quotas:\n  max_streams: 3\n");
  EXPECT_THAT(Overtone({"check", file}),
              HasSubstr("quotas.max_streams is 3 instead of 64\n" + file + ": no mistakes\n"));
  EXPECT_THAT(Overtone({"check", Path("none.yaml")}), HasSubstr("cannot be read"));
}

TEST_F(ConfigurationTest, TheDefaultFileIsWithoutMistakesAndChangesNothing) {
  EXPECT_EQ(Overtone({"explain", "keepalive_s"}).find("keepalive_s: number, s; default 10"), 0u);
  const std::string text = Overtone({"default"});
  const std::string file = Write(text.substr(0, text.rfind('\n') + 1));
  const std::string check = Overtone({"check", file});
  EXPECT_EQ(check.find(file + ": no mistakes\n"), 0u) << check;
}

TEST_F(ConfigurationTest, ShowTellsWhoSaidWhat) {
  const std::string file = Write("quotas: {max_streams: 3, max_calls_per_s: 0}\n");
  // As a container starts it.
  const std::string script = Path("server.sh");
  std::ofstream(script) << "#!/bin/sh\nOVERTONE_CONFIG=" << file
                        << " OVERTONE_QUOTAS_MAX_STREAMS=4 exec " << OVERTONE_SERVER << " \"$@\"\n";
  ASSERT_EQ(chmod(script.c_str(), 0700), 0);
  const auto server =
      ServerProcess::Start(script, {}, Path("server.log"), [] { return absl::OkStatus(); });
  ASSERT_TRUE(server.ok()) << server.status();
  const std::string address = (*server)->address();
  const std::string all = Overtone({"show", "--server", address});
  EXPECT_THAT(all, ContainsRegex("quotas.max_streams  *4  *64  *environment"));
  EXPECT_THAT(all, ContainsRegex("quotas.max_calls_per_s  *0  *50  *file"));
  EXPECT_THAT(all, ContainsRegex("data_dir  *:memory:  *overtone-data  *flag"));
  EXPECT_THAT(all, ContainsRegex("keepalive_s  *10  *10  *default"));
  const std::string changed = Overtone({"show", "--changed", "--json", "--server", address});
  EXPECT_THAT(changed, HasSubstr("{\"key\":\"quotas.max_streams\",\"value\":\"4\","
                                 "\"default_value\":\"64\",\"source\":\"environment\"}"));
  EXPECT_EQ(changed.find("keepalive_s"), std::string::npos);
}

TEST_F(ConfigurationTest, AServerDoesNotStartWithAVariableThatIsNobodys) {
  const std::string said =
      Run({"env", "OVERTONE_DATA_DIRS=/tmp", OVERTONE_SERVER, "--listen", "localhost:0"});
  EXPECT_THAT(said, HasSubstr("OVERTONE_DATA_DIRS is no option of the server; did you mean "
                              "'OVERTONE_DATA_DIR'?"));
  EXPECT_THAT(said, HasSubstr("ended with exit code 2"));
}

}  // namespace
}  // namespace overtone
