// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/synchronization/node_association.h"

#include <cstdlib>
#include <limits>
#include <map>
#include <set>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/tests/support/golden_case.h"

namespace overtone {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pair;

constexpr int64_t kUnknown = -1;

MapMission Mission(const std::vector<std::pair<int64_t, int64_t>>& index_and_stamp) {
  MapMission mission;
  for (const auto& [index, stamp] : index_and_stamp) {
    mission.nodes.emplace_back();
    mission.nodes.back().index = index;
    mission.nodes.back().stamp.ns = stamp;
  }
  return mission;
}

std::vector<NodePose> Onboard(const std::vector<std::pair<int64_t, int64_t>>& index_and_stamp) {
  std::vector<NodePose> nodes;
  for (const auto& [index, stamp] : index_and_stamp) nodes.push_back({index, {stamp}, Rigid3d()});
  return nodes;
}

std::vector<std::pair<int, int>> Pairs(const std::vector<NodeMatch>& matches) {
  std::vector<std::pair<int, int>> pairs;
  for (const NodeMatch& match : matches) pairs.emplace_back(match.server, match.onboard);
  return pairs;
}

TEST(NodeAssociation, GoesByKeyframeIndexWhateverTheStamps) {
  const auto matches = AssociateNodes(Mission({{0, 900}, {3, 0}, {7, 0}, {9, 0}}),
                                      Onboard({{3, 5}, {4, 0}, {7, 900}, {8, 0}}), 0);
  EXPECT_THAT(Pairs(matches), ElementsAre(Pair(1, 0), Pair(2, 2)));
}

TEST(NodeAssociation, GoesByStampWhereANodeHasNoIndex) {
  const auto matches =
      AssociateNodes(Mission({{kUnknown, 1'000'000'000}, {1, 2'000'000'000}}),
                     Onboard({{1, 1'100'000'000}, {2, 1'900'000'000}, {3, 9'000'000'000}}), 0.5);
  EXPECT_THAT(Pairs(matches), ElementsAre(Pair(0, 0), Pair(1, 1)));
}

// Closest first pairs 0 with the later stamp; the other pair would then go back in time.
TEST(NodeAssociation, NeverGoesBackInTime) {
  const auto matches =
      AssociateNodes(Mission({{kUnknown, 0}, {kUnknown, 100}}), Onboard({{0, -90}, {1, 10}}), 1);
  EXPECT_THAT(Pairs(matches), ElementsAre(Pair(0, 1)));
}

TEST(NodeAssociation, EmptySidesHaveNothingInCommon) {
  EXPECT_TRUE(AssociateNodes(Mission({}), Onboard({{0, 0}}), 1).empty());
  EXPECT_TRUE(AssociateNodes(Mission({{0, 0}}), Onboard({}), 1).empty());
}

TEST(CheckedTrajectory, SortsAndNormalises) {
  std::vector<NodePose> nodes = Onboard({{2, 0}, {0, 0}, {1, 0}});
  nodes[0].estimate_from_body.rotation.coeffs() *= 1.0005;
  const auto checked = CheckedTrajectory(nodes);
  ASSERT_TRUE(checked.ok()) << checked.status();
  EXPECT_EQ((*checked)[2].index, 2);
  EXPECT_NEAR((*checked)[2].estimate_from_body.rotation.norm(), 1, 1e-15);
}

TEST(CheckedTrajectory, NamesTheKeyframeItRefuses) {
  const auto expect_refused = [](const std::vector<NodePose>& nodes, const std::string& message) {
    const auto checked = CheckedTrajectory(nodes);
    EXPECT_EQ(checked.status().code(), absl::StatusCode::kInvalidArgument);
    EXPECT_THAT(std::string(checked.status().message()), HasSubstr(message));
  };
  std::vector<NodePose> nodes = Onboard({{4, 0}, {5, 0}, {6, 0}});
  nodes[1].estimate_from_body.translation.z() = std::numeric_limits<double>::quiet_NaN();
  expect_refused(nodes, "keyframe 5: pose is not finite");
  nodes = Onboard({{4, 0}, {5, 0}, {6, 0}});
  nodes[2].estimate_from_body.rotation.coeffs().setZero();
  expect_refused(nodes, "keyframe 6: quaternion");
  expect_refused(Onboard({{4, 0}, {7, 0}, {4, 0}}), "keyframe 4: given twice");
  expect_refused(Onboard({{-2, 0}}), "keyframe -2: negative");
}

std::vector<std::pair<int64_t, int64_t>> ReadStamps(const std::string& file, bool with_index) {
  const golden::Table table(golden::SharedFolder() / "sync" / file);
  std::vector<std::pair<int64_t, int64_t>> stamps;
  for (int i = 0; i < table.num_rows(); ++i) {
    stamps.emplace_back(with_index ? i : kUnknown, std::stoll(table.Cell(i, "t_ns")));
  }
  return stamps;
}

// The prototype takes for each of the first min(n) server stamps the closest onboard stamp, so that
// one of these may serve several. By hand: of the rows that share an onboard stamp the closest must
// stay, and a row must stay as well where no server stamp is closer to its onboard stamp; what
// remains of ours is one-to-one and within the tolerance.
TEST(NodeAssociation, KeepsThePrototypesPairsThatAreOneToOne) {
  if (!std::filesystem::exists(golden::SharedFolder() / "sync")) {
    GTEST_SKIP() << "no golden vectors in " << golden::SharedFolder();
  }
  for (const std::string name : {"est_longer", "est_shorter"}) {
    const auto server = ReadStamps(name + "_opt_ts.csv", /*with_index=*/false);
    const auto own = ReadStamps(name + "_est_ts.csv", /*with_index=*/true);
    const auto pairs = Pairs(AssociateNodes(Mission(server), Onboard(own), 0.5));
    const std::map<int, int> ours(pairs.begin(), pairs.end());

    std::set<int> used;
    for (const auto& [i, j] : pairs) {
      EXPECT_LE(std::abs(server[i].second - own[j].second), 500'000'000);
      EXPECT_TRUE(used.insert(j).second) << name << ": onboard " << j << " serves twice";
    }
    const golden::Table table(golden::SharedFolder() / "sync" / (name + "_pairs.csv"));
    int num_kept = 0;
    for (int row = 0; row < table.num_rows(); ++row) {
      const int i = table.Integer(row, "opt_idx"), j = table.Integer(row, "est_idx");
      const int64_t distance = std::abs(server[i].second - own[j].second);
      EXPECT_EQ(distance, std::stoll(table.Cell(row, "dt_ns")));
      bool mutual = true;
      for (const auto& other : server) {
        mutual = mutual && distance <= std::abs(other.second - own[j].second);
      }
      if (!mutual) continue;
      ++num_kept;
      ASSERT_EQ(ours.count(i), 1) << name << ": server " << i;
      EXPECT_EQ(ours.at(i), j) << name << ": server " << i;
    }
    EXPECT_GE(num_kept, 7) << name;
    EXPECT_LT(num_kept, table.num_rows()) << name << " has rows that share an onboard stamp";
  }
}

}  // namespace
}  // namespace overtone
