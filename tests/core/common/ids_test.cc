// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/common/ids.h"

#include <set>
#include <string>

#include "absl/hash/hash_testing.h"
#include "gtest/gtest.h"

namespace overtone {
namespace {

TEST(ValidateId, AcceptsLowerCaseLettersDigitsDashesAndUnderscores) {
  for (const std::string& id :
       {std::string("a"), std::string("0"), std::string("kaist-01_run"), std::string(63, 'x')}) {
    EXPECT_TRUE(ValidateId(id, "robot").ok()) << id;
  }
}

TEST(ValidateId, RefusesEverythingElseAndNamesTheField) {
  for (const std::string& id :
       {std::string(), std::string(64, 'x'), std::string("-a"), std::string("_a"), std::string("A"),
        std::string("a b"), std::string("a/b"), std::string("a.b"), std::string("\xc3\xa4"),
        std::string("a\0b", 3), std::string(100000000, 'a')}) {
    const absl::Status status = ValidateId(id, "header.robot");
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << id.substr(0, 70);
    EXPECT_EQ(status.message().find("header.robot: "), 0u) << status;
    EXPECT_LT(status.message().size(), 400u) << "a hostile id must not inflate the message";
  }
}

TEST(MissionId, OrdersByRobotThenMission) {
  const std::set<MissionId> ids = {{"b", "1"}, {"a", "2"}, {"a", "1"}};
  std::string order;
  for (const MissionId& id : ids) order += ToString(id) + " ";
  EXPECT_EQ(order, "a/1 a/2 b/1 ");
}

TEST(NodeId, OrdersByMissionThenIndexAsANumber) {
  const NodeId second{{"a", "1"}, 2}, tenth{{"a", "1"}, 10}, other{{"a", "2"}, 0};
  EXPECT_LT(second, tenth);
  EXPECT_LT(tenth, other);
  EXPECT_NE(second, tenth);
  EXPECT_EQ(ToString(tenth), "a/1:10");
}

TEST(NodeId, HashAgreesWithEquality) {
  EXPECT_TRUE(absl::VerifyTypeImplementsAbslHashCorrectly({
      NodeId{},
      NodeId{{"a", "1"}, 0},
      NodeId{{"a", "1"}, 1},
      NodeId{{"a1", ""}, 0},  // same characters, other split
      NodeId{{"", "a1"}, 0},
  }));
}

}  // namespace
}  // namespace overtone
