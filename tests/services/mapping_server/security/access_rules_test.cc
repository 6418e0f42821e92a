// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/security/access_rules.h"

#include <string>

#include "absl/strings/str_replace.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace overtone {
namespace {

using ::testing::StartsWith;

const PeerIdentity kAnna = {PeerRole::kRobot, "anna"};
const PeerIdentity kCarl = {PeerRole::kRobot, "carl"};
const PeerIdentity kOlga = {PeerRole::kOperator, "olga"};
const PeerIdentity kOperatorAnna = {PeerRole::kOperator, "anna"};

AccessRules Rules() {
  AccessRules rules;
  rules.maps["town"] = {{"anna"}, {"olga"}};
  rules.maps["park"] = {{"*"}, {}};
  rules.maps["*"] = {{}, {"root"}};
  return rules;
}

TEST(AccessRules, ANameIsGrantedForItsRoleOnly) {
  const AccessRules rules = Rules();
  EXPECT_TRUE(rules.IsGranted(kAnna, "town"));
  EXPECT_FALSE(rules.IsGranted(kOperatorAnna, "town"));
  EXPECT_FALSE(rules.IsGranted(kCarl, "town"));
  EXPECT_TRUE(rules.IsGranted(kOlga, "town"));
}

TEST(AccessRules, AnAsteriskStandsForEveryNameOrEveryMap) {
  const AccessRules rules = Rules();
  EXPECT_TRUE(rules.IsGranted(kCarl, "park"));
  EXPECT_FALSE(rules.IsGranted(kOlga, "park"));
  for (const char* map : {"town", "park", "never-heard-of"}) {
    EXPECT_TRUE(rules.IsGranted({PeerRole::kOperator, "root"}, map)) << map;
  }
  // A map that is really called so does not exist; its grants must not become everybody's.
  EXPECT_FALSE(rules.IsGranted(kAnna, "*"));
}

TEST(AccessRules, RobotsReadTheirMapsAndWriteTheirOwnMissions) {
  const AccessRules rules = Rules();
  EXPECT_TRUE(rules.MayRead(kAnna, "town").ok());
  EXPECT_TRUE(rules.MayWrite(kAnna, "town", "anna").ok());
  const absl::Status other = rules.MayWrite(kAnna, "town", "bert", "header.");
  EXPECT_EQ(other.code(), absl::StatusCode::kPermissionDenied);
  EXPECT_EQ(other.message(), "header.mission.robot: 'bert', but the certificate is robot/anna's");
  EXPECT_THAT(std::string(rules.MayWrite(kCarl, "town", "carl", "header.").message()),
              StartsWith("header.map: "));
  EXPECT_EQ(rules.MayAdminister(kAnna, "town").code(), absl::StatusCode::kPermissionDenied);
}

TEST(AccessRules, OperatorsReadAndAdministerTheirMapsAndWriteNothing) {
  const AccessRules rules = Rules();
  EXPECT_TRUE(rules.MayRead(kOlga, "town").ok());
  EXPECT_TRUE(rules.MayAdminister(kOlga, "town").ok());
  EXPECT_EQ(rules.MayAdminister(kOlga, "park").code(), absl::StatusCode::kPermissionDenied);
  // Not even the missions of a robot of that name.
  EXPECT_EQ(rules.MayWrite(kOlga, "town", "olga").code(), absl::StatusCode::kPermissionDenied);
}

}  // namespace
}  // namespace overtone
