// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/evaluation_suite.h"

#include <set>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace overtone {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

bool IsFolderName(const std::string& name) {
  return !name.empty() &&
         name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_") == std::string::npos;
}

TEST(EvaluationSuite, ThePapersExperimentsAreInItsOrder) {
  const auto suite = FindEvaluationSuite("paper");
  ASSERT_TRUE(suite.ok()) << suite.status();
  std::vector<std::string> names;
  for (const Experiment& experiment : (*suite)->experiments) names.push_back(experiment.name);
  EXPECT_THAT(names, ElementsAre("indoor_outdoor_drift", "degenerate_tunnel", "sudden_jump",
                                 "tunnel_urban_cave"));
}

TEST(EvaluationSuite, AnUnknownNameIsRefusedWithThoseThereAre) {
  const auto suite = FindEvaluationSuite("papers");
  EXPECT_EQ(suite.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(suite.status().message()), HasSubstr("\"papers\""));
  for (const EvaluationSuite& known : EvaluationSuites()) {
    EXPECT_THAT(std::string(suite.status().message()), HasSubstr(known.name));
  }
}

TEST(EvaluationSuite, EveryExperimentHasAFolderOfItsOwn) {
  for (const EvaluationSuite& suite : EvaluationSuites()) {
    EXPECT_TRUE(IsFolderName(suite.name)) << suite.name;
    EXPECT_FALSE(suite.experiments.empty()) << suite.name;
    std::set<std::string> names;
    for (const Experiment& experiment : suite.experiments) {
      EXPECT_TRUE(IsFolderName(experiment.name)) << experiment.name;
      EXPECT_TRUE(names.insert(experiment.name).second) << experiment.name;
    }
  }
}

}  // namespace
}  // namespace overtone
