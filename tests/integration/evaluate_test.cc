// SPDX-License-Identifier: Apache-2.0
// `overtone evaluate` as a user runs it: simulated data, real processes, a table at the end.
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/client/cli/child_process.h"

namespace overtone {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class EvaluateTest : public ::testing::Test {
 protected:
  EvaluateTest() : folder_(::testing::TempDir() + "overtone_evaluate_" + std::to_string(getpid())) {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~EvaluateTest() override { fs::remove_all(folder_); }

  // What it printed until it ended; its last status goes to `end`.
  std::string Evaluate(const std::string& suite, absl::Status* end) const {
    auto child = ChildProcess::Start(
        {"evaluate",
         {OVERTONE_PROGRAM, "evaluate", "--suite", suite, "--out", folder_ + "/out"},
         folder_ + "/stderr.txt"});
    EXPECT_TRUE(child.ok()) << child.status();
    std::string text;
    for (;;) {
      const auto line = (*child)->ReadLine(absl::Minutes(2), [] { return absl::OkStatus(); });
      if (!line.ok()) {
        *end = line.status();
        return text;
      }
      text += *line + "\n";
    }
  }

  std::string Read(const std::string& name) const {
    std::ifstream file(folder_ + "/" + name);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  }

  std::string folder_;
};

TEST_F(EvaluateTest, TheSmallestSuiteTiesItsTeamTogetherAndTabulatesIt) {
  absl::Status end;
  const std::string text = Evaluate("smoke", &end);
  EXPECT_THAT(std::string(end.message()), HasSubstr("exit code 0")) << Read("stderr.txt");
  EXPECT_THAT(text, HasSubstr("onboard [m]"));
  const std::string csv = Read("out/smoke.csv");
  EXPECT_THAT(csv, HasSubstr("\nsmoke,robot1,"));
  EXPECT_THAT(csv, HasSubstr("\nsmoke,team,"));
  EXPECT_THAT(Read("out/smoke.md"), HasSubstr("| smoke | robot2 |"));
  EXPECT_TRUE(fs::exists(folder_ + "/out/smoke/run/report.html"));
  EXPECT_TRUE(fs::exists(folder_ + "/out/smoke/data/robot1/odom_poses.txt"));
  // The two start side by side: one component, found from their clouds alone.
  const std::string team = csv.substr(csv.find("\nsmoke,team,"));
  const size_t components = team.rfind(',', team.rfind(',') - 1) + 1;
  EXPECT_EQ(team.substr(components, 2), "1,") << csv;
}

TEST_F(EvaluateTest, AnUnknownSuiteIsRefusedWithTheList) {
  absl::Status end;
  Evaluate("papers", &end);
  EXPECT_THAT(std::string(end.message()), HasSubstr("exit code 2"));
  EXPECT_THAT(Read("stderr.txt"), HasSubstr("there are: paper, smoke"));
}

}  // namespace
}  // namespace overtone
