// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/synchronization/resistance_covariance.h"

#include <algorithm>
#include <iostream>
#include <random>

#include "Eigen/Dense"
#include "gtest/gtest.h"
#include "overtone/core/spectral/graph_laplacian.h"
#include "overtone/core/spectral/kron_reduction.h"
#include "overtone/tests/support/drifting_mission.h"

namespace overtone {
namespace {

struct Map {
  std::vector<Rigid3d> poses;
  std::vector<InformationEdge> edges;
};

double Uniform(std::mt19937& random, double from, double to) {
  return std::uniform_real_distribution<double>(from, to)(random);
}

// A winding mission whose steps are good to 1 to 3 cm and 2 to 6 mrad.
Map Chain(int num_nodes, int seed) {
  std::mt19937 random(seed);
  Map map;
  map.poses = MakeDriftingMission(num_nodes, seed).truth;
  for (int i = 1; i < num_nodes; ++i) {
    map.edges.push_back({i - 1, i, std::pow(Uniform(random, 0.01, 0.03), -2),
                         std::pow(Uniform(random, 0.002, 0.006), -2)});
  }
  return map;
}

// Closures of 3 cm and 9 mrad between random poses.
Map WithLoops(Map map, int num_loops, int seed) {
  std::mt19937 random(seed);
  const int num_nodes = static_cast<int>(map.poses.size());
  while (num_loops > 0) {
    const int first = static_cast<int>(random() % num_nodes);
    const int second = static_cast<int>(random() % num_nodes);
    if (std::abs(first - second) < 10) continue;
    map.edges.push_back({first, second, std::pow(0.03, -2), std::pow(0.009, -2)});
    --num_loops;
  }
  return map;
}

// The joint marginal, by inverting the information of all poses but the first: error =
// delta_second - Ad(second_from_first) delta_first at each edge's second end, perturbations on the
// right; at the mean the residual's own Jacobian is the identity.
class FullMarginals {
 public:
  explicit FullMarginals(const Map& map) : poses_(map.poses) {
    const int n = static_cast<int>(map.poses.size());
    Eigen::MatrixXd information = Eigen::MatrixXd::Zero(6 * n, 6 * n);
    for (const InformationEdge& edge : map.edges) {
      Vector6d diagonal;
      diagonal << Eigen::Vector3d::Constant(edge.translation),
          Eigen::Vector3d::Constant(edge.rotation);
      const Matrix6d q = diagonal.asDiagonal();
      const Matrix6d j = -Adjoint(map.poses[edge.second].Inverse() * map.poses[edge.first]);
      information.block<6, 6>(6 * edge.first, 6 * edge.first) += j.transpose() * q * j;
      information.block<6, 6>(6 * edge.first, 6 * edge.second) += j.transpose() * q;
      information.block<6, 6>(6 * edge.second, 6 * edge.first) += q * j;
      information.block<6, 6>(6 * edge.second, 6 * edge.second) += q;
    }
    covariance_ = Eigen::MatrixXd::Zero(6 * n, 6 * n);
    covariance_.bottomRightCorner(6 * n - 6, 6 * n - 6) =
        information.bottomRightCorner(6 * n - 6, 6 * n - 6)
            .llt()
            .solve(Eigen::MatrixXd::Identity(6 * n - 6, 6 * n - 6));
  }

  Matrix6d Of(int from, int to) const {
    const Matrix6d j = -Adjoint(poses_[to].Inverse() * poses_[from]);
    const auto block = [this](int a, int b) { return covariance_.block<6, 6>(6 * a, 6 * b); };
    return j * block(from, from) * j.transpose() + j * block(from, to) +
           block(to, from) * j.transpose() + block(to, to);
  }

 private:
  const std::vector<Rigid3d> poses_;
  Eigen::MatrixXd covariance_;
};

ResistanceCovariance Make(const Map& map) {
  auto result = ResistanceCovariance::Create(map.poses, map.edges);
  EXPECT_TRUE(result.ok()) << result.status();
  return *std::move(result);
}

TEST(ResistanceCovariance, OfAChainIsTheJointMarginal) {
  for (int seed = 1; seed <= 3; ++seed) {
    const Map map = Chain(80, seed);
    const FullMarginals marginals(map);
    const ResistanceCovariance resistance = Make(map);
    for (const auto& [from, to] : {std::pair(0, 79), std::pair(12, 50), std::pair(50, 12)}) {
      const Matrix6d expected = marginals.Of(from, to);
      const auto covariance = resistance.Covariance(from, to);
      ASSERT_TRUE(covariance.ok()) << covariance.status();
      EXPECT_LT((*covariance - expected).norm(), 1e-8 * expected.norm()) << from << "-" << to;
    }
  }
}

TEST(ResistanceCovariance, WithLoopsIsNeverBelowTheJointMarginalAndNotFarAbove) {
  for (const int num_loops : {1, 5, 20, 80}) {
    std::vector<double> positions, headings;
    for (int seed = 1; seed <= 5; ++seed) {
      const Map map = WithLoops(Chain(80, seed), num_loops, seed);
      const FullMarginals marginals(map);
      const ResistanceCovariance resistance = Make(map);
      for (int from = 0; from < 80; from += 9) {
        for (int to = from + 7; to < 80; to += 11) {
          const Matrix6d expected = marginals.Of(from, to);
          const Matrix6d covariance = *resistance.Covariance(from, to);
          const Eigen::SelfAdjointEigenSolver<Matrix6d> excess(covariance - expected);
          EXPECT_GT(excess.eigenvalues().minCoeff(), -1e-9 * covariance.norm())
              << from << "-" << to << ", seed " << seed;
          positions.push_back(std::sqrt(covariance.topLeftCorner<3, 3>().trace() /
                                        expected.topLeftCorner<3, 3>().trace()));
          headings.push_back(std::sqrt(covariance.bottomRightCorner<3, 3>().trace() /
                                       expected.bottomRightCorner<3, 3>().trace()));
        }
      }
    }
    const auto median = [](std::vector<double> values) {
      std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
      return values[values.size() / 2];
    };
    const double largest_position = *std::max_element(positions.begin(), positions.end());
    const double largest_heading = *std::max_element(headings.begin(), headings.end());
    std::cout << num_loops << " loops: standard deviation over the joint marginal's, median and "
              << "largest: translation " << median(positions) << ", " << largest_position
              << ", rotation " << median(headings) << ", " << largest_heading << "\n";
    EXPECT_LT(median(positions), 3);
    EXPECT_LT(median(headings), 3);
  }
}

SparseMatrix LaplacianOf(const Map& map, double InformationEdge::*information) {
  const int n = static_cast<int>(map.poses.size());
  std::vector<Eigen::Triplet<double>> entries;
  for (const InformationEdge& edge : map.edges) {
    entries.emplace_back(edge.first, edge.second, edge.*information);
    entries.emplace_back(edge.second, edge.first, edge.*information);
  }
  SparseMatrix adjacency(n, n);
  adjacency.setFromTriplets(entries.begin(), entries.end());
  return GraphLaplacian(adjacency);
}

TEST(ResistanceCovariance, KronReductionLeavesTheResistancesAsTheyAre) {
  const Map map = WithLoops(Chain(200, 1), 30, 1);
  const ResistanceCovariance full = Make(map);
  for (const int stride : {2, 5}) {
    std::vector<int> kept;
    for (int i = 0; i < 200; i += stride) kept.push_back(i);
    for (const bool translation : {true, false}) {
      const auto reduced =
          KronReduction(LaplacianOf(map, translation ? &InformationEdge::translation
                                                     : &InformationEdge::rotation),
                        kept);
      ASSERT_TRUE(reduced.ok()) << reduced.status();
      const auto resistance = EffectiveResistance::Create(reduced->laplacian);
      ASSERT_TRUE(resistance.ok()) << resistance.status();
      for (int i = 0; i < kept.size(); i += 3) {
        for (int j = i + 1; j < kept.size(); j += 4) {
          const double expected = translation ? full.translation().Between(kept[i], kept[j])
                                              : full.rotation().Between(kept[i], kept[j]);
          EXPECT_NEAR(resistance->Between(i, j) / expected, 1, 1e-9);
        }
      }
    }
  }
}

TEST(ResistanceCovariance, ReducingAChainMovesTheLeverTermByLessThanAnEdge) {
  const Map map = Chain(101, 2);
  Map reduced;
  for (int i = 0; i <= 100; i += 5) {
    reduced.poses.push_back(map.poses[i]);
    if (i == 0) continue;
    InformationEdge edge = {i / 5 - 1, i / 5, 0, 0};  // in series
    for (int k = i - 5; k < i; ++k) {
      edge.translation += 1 / map.edges[k].translation;
      edge.rotation += 1 / map.edges[k].rotation;
    }
    edge.translation = 1 / edge.translation;
    edge.rotation = 1 / edge.rotation;
    reduced.edges.push_back(edge);
  }
  const Matrix6d expected = *Make(map).Covariance(0, 100);
  const Matrix6d covariance = *Make(reduced).Covariance(0, 20);
  const auto trace = [](const Matrix6d& m, int begin) {
    return m.diagonal().segment<3>(begin).sum();
  };
  EXPECT_NEAR(trace(covariance, 3), trace(expected, 3), 1e-12);
  const double ratio = std::sqrt(trace(covariance, 0) / trace(expected, 0));
  std::cout << "translation after reduction to every fifth: " << ratio << "\n";
  EXPECT_NEAR(ratio, 1, 0.1);
}

TEST(ResistanceCovariance, RefusesWhatIsNoEdgeAndKnowsWhereNoPathLeads) {
  Map map = Chain(4, 1);
  map.edges[1].rotation = 0;
  EXPECT_EQ(ResistanceCovariance::Create(map.poses, map.edges).status().message(),
            "edges[1]: not a valid edge");
  map.edges.erase(map.edges.begin() + 1);  // 0 - 1 and 2 - 3 are left
  const ResistanceCovariance parts = Make(map);
  EXPECT_EQ(parts.Covariance(0, 3).status().code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_TRUE(parts.Covariance(2, 3).ok());
  EXPECT_EQ(parts.Covariance(2, 2)->norm(), 0);
}

}  // namespace
}  // namespace overtone
