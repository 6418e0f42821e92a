// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/security/access_file.h"

#include <fstream>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace overtone {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

absl::StatusOr<AccessRules> Read(const std::string& text) {
  const std::string path = ::testing::TempDir() + "/access.yaml";
  std::ofstream(path) << text;
  return ReadAccessFile(path);
}

TEST(AccessFile, SaysWhoMayUseWhichMapAndWhoIsRevoked) {
  const auto rules =
      Read(absl::StrCat("maps:\n  town:\n    robots: [anna, bert]\n    operators: [\"*\"]\n"
                        "  \"*\": {operators: [olga]}\n  empty:\n"
                        "revoked:\n- robot/bert\n- \"sha256:",
                        "AB:CD", std::string(60, '0'), "\"\n"));
  ASSERT_TRUE(rules.ok()) << rules.status();
  ASSERT_EQ(rules->maps.size(), 3);
  EXPECT_THAT(rules->maps.at("town").robots, ElementsAre("anna", "bert"));
  EXPECT_THAT(rules->maps.at("town").operators, ElementsAre("*"));
  EXPECT_THAT(rules->maps.at("*").operators, ElementsAre("olga"));
  EXPECT_TRUE(rules->maps.at("empty").robots.empty());
  EXPECT_THAT(rules->revoked, ElementsAre(PeerIdentity{PeerRole::kRobot, "bert"}));
  EXPECT_THAT(rules->revoked_fingerprints, ElementsAre("abcd" + std::string(60, '0')));
}

TEST(AccessFile, AnEmptyOneLetsNobodyIn) {
  const auto rules = Read("# nobody yet\n");
  ASSERT_TRUE(rules.ok()) << rules.status();
  EXPECT_FALSE(rules->IsGranted({PeerRole::kRobot, "anna"}, "town"));
}

TEST(AccessFile, MistakesAreRefusedWithTheirLine) {
  const std::pair<std::string, std::string> cases[] = {
      {"- town\n", ":1: the file must be a mapping"},
      {"maps:\n  town:\nrevokes: []\n", ":3: unknown key 'revokes'; known are maps, revoked"},
      {"maps:\n  town:\n    robot: [anna]\n", ":3: unknown key 'robot'"},
      {"maps:\n  town:\n    robots: anna\n", ":3: robots must be a list"},
      {"maps:\n  town:\n    robots: [anna, [bert]]\n", ":3: robots must be a list of names"},
      {"maps:\n  town:\n    robots: [Anna]\n", ":3: 'Anna' is neither"},
      {"maps:\n  ../town:\n", ":2: '../town' is neither"},
      {"maps: [town]\n", ":1: maps must be a mapping"},
      {"maps:\n  town:\n  town:\n", ":3: 'town' is given twice"},
      {"revoked:\n- anna\n", ":2: 'anna' is none of robot/<id>"},
      {"revoked:\n- robot/bert\n- sha256:abcd\n", ":3: sha256: must be followed by"},
      {"revoked: {robot: bert}\n", ":1: revoked must be a list"},
      {"maps: {town\n", ":"},
  };
  for (const auto& [text, error] : cases) {
    const auto rules = Read(text);
    EXPECT_EQ(rules.status().code(), absl::StatusCode::kInvalidArgument) << text;
    EXPECT_THAT(std::string(rules.status().message()), HasSubstr("/access.yaml" + error)) << text;
  }
  EXPECT_EQ(ReadAccessFile("/nowhere/access.yaml").status().code(), absl::StatusCode::kNotFound);
}

}  // namespace
}  // namespace overtone
