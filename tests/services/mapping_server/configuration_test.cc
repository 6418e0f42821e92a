// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/configuration.h"

#include <fstream>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/tests/services/mapping_server/server_fixture.h"

namespace overtone {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

std::string Write(const std::string& text) {
  const std::string path = ::testing::TempDir() + "/configuration.yaml";
  std::ofstream(path) << text;
  return path;
}

v1::ConfigurationValue Find(const v1::GetConfigurationResponse& response, const std::string& key) {
  for (const v1::ConfigurationValue& value : response.values()) {
    if (value.key() == key) return value;
  }
  ADD_FAILURE() << "no " << key;
  return {};
}

TEST(Configuration, FlagsStandAboveTheEnvironmentAboveTheFileAboveDefaults) {
  ConfigurationInput input;
  input.file = Write("listen: localhost:1\ndata_dir: file\nlog_level: error\nkeepalive_s: 20\n");
  input.environment = {"OVERTONE_DATA_DIR=environment", "OVERTONE_LOG_LEVEL=warning"};
  input.flags = {{"log_level", "debug"}};
  const auto configuration = ReadConfiguration(input);
  ASSERT_TRUE(configuration.ok()) << configuration.status();
  EXPECT_EQ(configuration->options.keepalive_s, 20);
  EXPECT_EQ(configuration->options.data_dir, "environment");
  EXPECT_EQ(configuration->options.log_level, "debug");
  EXPECT_EQ(configuration->options.shutdown_s, ServerOptions().shutdown_s);

  const v1::GetConfigurationResponse response = DescribeConfiguration(*configuration);
  EXPECT_EQ(response.values_size(), OptionKeys().size());
  EXPECT_EQ(response.values(0).key(), OptionKeys().front());
  EXPECT_EQ(Find(response, "log_level").source(), "flag");
  EXPECT_EQ(Find(response, "log_level").value(), "debug");
  EXPECT_EQ(Find(response, "log_level").default_value(), "info");
  EXPECT_EQ(Find(response, "data_dir").source(), "environment");
  EXPECT_EQ(Find(response, "keepalive_s").source(), "file");
  EXPECT_EQ(Find(response, "shutdown_s").source(), "default");
}

TEST(Configuration, AValueOutOfItsRangeIsNamedWithWhoSaidIt) {
  ConfigurationInput input;
  input.file = Write("listen: localhost:1\nlimits:\n  max_maps: 0\n");
  const std::string in_file(ReadConfiguration(input).status().message());
  EXPECT_EQ(in_file, input.file + ":3: limits.max_maps: 0 is not in [1, 10000]");
  input.environment = {"OVERTONE_LIMITS_MAX_MAPS=-1"};
  EXPECT_EQ(ReadConfiguration(input).status().message(),
            "OVERTONE_LIMITS_MAX_MAPS: limits.max_maps: -1 is not in [1, 10000]");
  input.environment = {"OVERTONE_LIMITS_MAX_MAPS=1"};
  input.flags = {{"listen", "nowhere"}};
  EXPECT_THAT(std::string(ReadConfiguration(input).status().message()),
              StartsWith("--listen: listen: 'nowhere'"));
  input.file = "/nowhere.yaml";
  EXPECT_EQ(ReadConfiguration(input).status().code(), absl::StatusCode::kNotFound);
}

// An option that is checked under another name than the file's could not be found in the file.
TEST(Configuration, EveryNumberIsCheckedUnderTheNameThatTheFileGivesIt) {
  ServerOptions defaults;
  for (const Option& option : OptionTable(defaults)) {
    if (option.type != "number" && option.type != "integer") continue;
    ConfigurationInput input;
    input.flags = {{option.key, option.type == "number" ? ".nan" : "-1"}};
    const absl::Status status = ReadConfiguration(input).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << option.key;
    EXPECT_THAT(std::string(status.message()), StartsWith("--"));
    EXPECT_THAT(std::string(status.message()), HasSubstr(absl::StrCat(": ", option.key)));
  }
}

using GetConfigurationTest = testing::ServerTest;

TEST_F(GetConfigurationTest, TellsWhatIsInForce) {
  const auto response = Call<v1::GetConfigurationResponse>(
      &v1::MapAdminService::Stub::GetConfiguration, v1::GetConfigurationRequest());
  EXPECT_EQ(response.values_size(), OptionKeys().size());
  // Set by this program, not by a file, the environment or a flag.
  EXPECT_EQ(Find(response, "data_dir").value(), ":memory:");
  EXPECT_EQ(Find(response, "data_dir").default_value(), "overtone-data");
  EXPECT_EQ(Find(response, "data_dir").source(), "");
  EXPECT_EQ(Find(response, "limits.max_maps").source(), "default");
}

}  // namespace
}  // namespace overtone
