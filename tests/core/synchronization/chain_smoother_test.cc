// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/synchronization/chain_smoother.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "Eigen/Cholesky"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/core/estimation/pose_graph_optimizer.h"

namespace overtone {
namespace {

Vector6d Vector(double x, double y, double z, double rx, double ry, double rz) {
  return (Vector6d() << x, y, z, rx, ry, rz).finished();
}

OdometryStep Step(const Rigid3d& previous_from_this, const Matrix6d& covariance) {
  return {previous_from_this, covariance, covariance.inverse()};
}

// A drifting run through space: every step has a full covariance and a true motion that differs
// from what it measured.
struct DriftingRun {
  std::vector<OdometryStep> odometry;
  std::vector<Rigid3d> estimate;  // odometry composed
  std::vector<Rigid3d> truth;

  DriftingRun(int num_poses, double sigma_translation, double sigma_rotation, int seed,
              double turn_rad = 0.1) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    const auto noise = [&] {
      return Vector(normal(random), normal(random), normal(random), normal(random), normal(random),
                    normal(random));
    };
    const Vector6d sigma = (Vector6d() << Eigen::Vector3d::Constant(sigma_translation),
                            Eigen::Vector3d::Constant(sigma_rotation))
                               .finished();
    odometry.resize(num_poses);
    estimate = truth = {Exp(noise())};
    for (int i = 1; i < num_poses; ++i) {
      const Rigid3d motion =
          Exp(Vector(1, 0, 0, 0.2 * turn_rad, turn_rad * std::sin(0.05 * i), turn_rad));
      Matrix6d mixing = 0.2 * Matrix6d::NullaryExpr([&] { return normal(random); });
      mixing.diagonal().array() += 1;
      const Matrix6d root = sigma.asDiagonal() * mixing;
      odometry[i] = Step(motion * Exp(root * noise()), root * root.transpose());
      truth.push_back(truth.back() * motion);
      estimate.push_back(estimate.back() * odometry[i].previous_from_this);
    }
  }

  Chord TrueChord(int from, int to, double sigma) const {
    return {from, to, truth[from].Inverse() * truth[to], Matrix6d::Identity() / (sigma * sigma)};
  }
};

double LargestDistance(const std::vector<Rigid3d>& a, const std::vector<Rigid3d>& b) {
  double largest = 0;
  for (int i = 0; i < a.size(); ++i) {
    largest = std::max(largest, Log(a[i].Inverse() * b[i]).norm());
  }
  return largest;
}

PoseGraphResult BatchOptimum(const DriftingRun& run, const std::vector<Chord>& chords) {
  PoseGraph graph;
  graph.poses = run.estimate;
  for (int i = 1; i < run.estimate.size(); ++i) {
    graph.edges.push_back({i - 1, i, run.odometry[i].previous_from_this,
                           run.odometry[i].information, EdgeKind::kOdometry});
  }
  for (const Chord& chord : chords) {
    graph.edges.push_back(
        {chord.from, chord.to, chord.from_tform_to, chord.information, EdgeKind::kLoopClosure});
  }
  const auto result = OptimizePoseGraph(graph, PoseGraphOptimizerOptions());
  EXPECT_TRUE(result.ok()) << result.status();
  return *result;
}

// The textbook's Gauss-Newton: every pose but the first a variable, dense normal equations.
class DenseGaussNewton {
 public:
  DenseGaussNewton(const DriftingRun& run, const std::vector<Chord>& chords)
      : poses_(run.estimate), edges_(chords) {
    for (int i = 1; i < poses_.size(); ++i) {
      edges_.push_back({i - 1, i, run.odometry[i].previous_from_this, run.odometry[i].information});
    }
  }

  const std::vector<Rigid3d>& Solve(int num_steps) {
    for (int k = 0; k < num_steps; ++k) Step();
    return poses_;
  }

 private:
  void Step() {
    const int size = 6 * static_cast<int>(poses_.size());
    Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(size, size);
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(size);
    for (const Chord& edge : edges_) {
      const Rigid3d from_tform_to = poses_[edge.from].Inverse() * poses_[edge.to];
      const Vector6d r = Log(edge.from_tform_to.Inverse() * from_tform_to);
      Eigen::Matrix<double, 6, 12> jacobian;
      jacobian.rightCols<6>() = InverseRightJacobian(r);
      jacobian.leftCols<6>() = -jacobian.rightCols<6>() * Adjoint(from_tform_to.Inverse());
      const int at[] = {6 * edge.from, 6 * edge.to};
      for (const int i : {0, 1}) {
        const auto weighted = jacobian.middleCols<6>(6 * i).transpose() * edge.information;
        gradient.segment<6>(at[i]) += weighted * r;
        for (const int j : {0, 1}) {
          hessian.block<6, 6>(at[i], at[j]) += weighted * jacobian.middleCols<6>(6 * j);
        }
      }
    }
    const int free = size - 6;
    const Eigen::VectorXd moves =
        hessian.bottomRightCorner(free, free).llt().solve(-gradient.tail(free));
    for (int i = 1; i < poses_.size(); ++i) {
      poses_[i] = poses_[i] * Exp(moves.segment<6>(6 * (i - 1)));
    }
  }

  std::vector<Rigid3d> poses_;
  std::vector<Chord> edges_;
};

// Two steps with variances 1 and 3, and a chord with variance 2 that measures 0.6 m more: each
// takes its share of the total variance, 1/6, 3/6 and 2/6.
TEST(ChainSmoother, SharesADisagreementInProportionToTheVariances) {
  const Rigid3d metre(Eigen::Quaterniond::Identity(), Eigen::Vector3d::UnitX());
  const std::vector<OdometryStep> odometry = {OdometryStep(), Step(metre, Matrix6d::Identity()),
                                              Step(metre, 3 * Matrix6d::Identity())};
  const std::vector<Rigid3d> poses = {Rigid3d(), metre, metre * metre};
  Chord chord{0, 2, Rigid3d(Eigen::Quaterniond::Identity(), Eigen::Vector3d(2.6, 0, 0)),
              Matrix6d::Identity() / 2};
  const auto result = SmoothChain(poses, odometry, {chord}, ChainSmootherOptions());
  ASSERT_TRUE(result.ok()) << result.status();
  EXPECT_NEAR(result->poses[1].translation.x(), 1.1, 1e-12);
  EXPECT_NEAR(result->poses[2].translation.x(), 2.4, 1e-12);
  EXPECT_NEAR(result->initial_cost, 0.5 * 0.36 / 2, 1e-12);
}

TEST(ChainSmoother, ReachesTheOptimumOfTheWholeChain) {
  for (const int seed : {1, 2, 3}) {
    const DriftingRun run(400, 0.05, 0.01, seed);
    std::mt19937 random(seed);
    std::vector<Chord> chords;
    for (int k = 0; k < 30; ++k) {
      const int from = random() % 390;
      chords.push_back(run.TrueChord(from, from + 1 + random() % (399 - from), 0.02));
      if (k % 2 == 0) std::swap(chords.back().from, chords.back().to);
      chords.back() = run.TrueChord(chords.back().from, chords.back().to, 0.02);
    }
    const auto result = SmoothChain(run.estimate, run.odometry, chords, ChainSmootherOptions());
    ASSERT_TRUE(result.ok()) << result.status();
    const PoseGraphResult optimum = BatchOptimum(run, chords);
    EXPECT_TRUE(result->converged);
    EXPECT_NEAR(result->initial_cost, optimum.initial_cost, 1e-6 * optimum.initial_cost);
    EXPECT_NEAR(result->final_cost, optimum.final_cost, 1e-3);
    const double correction = LargestDistance(run.estimate, optimum.poses);
    EXPECT_GT(correction, 1);
    EXPECT_LT(LargestDistance(result->poses, optimum.poses), 1e-5 * correction) << "seed " << seed;
    EXPECT_LE(result->iterations, 6);
  }
}

TEST(ChainSmoother, EqualsTheDenseSolutionToEightDigits) {
  for (const int seed : {1, 2, 3}) {
    const DriftingRun run(60, 0.05, 0.01, seed);
    const std::vector<Chord> chords = {run.TrueChord(0, 20, 0.02), run.TrueChord(45, 10, 0.02),
                                       run.TrueChord(30, 31, 0.01), run.TrueChord(20, 50, 0.05),
                                       run.TrueChord(10, 45, 0.03)};
    ChainSmootherOptions options;
    options.cost_tolerance = 1e-18;
    const auto result = SmoothChain(run.estimate, run.odometry, chords, options);
    ASSERT_TRUE(result.ok()) << result.status();
    const std::vector<Rigid3d>& expected = DenseGaussNewton(run, chords).Solve(/*num_steps=*/12);
    EXPECT_GT(LargestDistance(run.estimate, expected), 0.1);
    EXPECT_LT(LargestDistance(result->poses, expected), 1e-8) << "seed " << seed;
  }
}

// What the default tolerance leaves, against standard deviations of centimetres.
TEST(ChainSmoother, StopsWithinATenthOfAMillimetreOfTheOptimum) {
  const DriftingRun run(60, 0.05, 0.01, 4);
  const std::vector<Chord> chords = {run.TrueChord(0, 20, 0.02), run.TrueChord(45, 10, 0.02)};
  const auto result = SmoothChain(run.estimate, run.odometry, chords, ChainSmootherOptions());
  ASSERT_TRUE(result.ok()) << result.status();
  const std::vector<Rigid3d>& expected = DenseGaussNewton(run, chords).Solve(/*num_steps=*/12);
  EXPECT_LT(LargestDistance(result->poses, expected), 1e-4);
}

// The end of the run is hundreds of metres from where it belongs, and heads elsewhere.
TEST(ChainSmoother, CorrectsHundredsOfMetresAndAQuarterTurn) {
  constexpr int kLast = 4999;
  double largest_turn = 0;
  for (const int seed : {1, 2, 3, 4, 5}) {
    const DriftingRun run(kLast + 1, 0.02, 0.01, seed, /*turn_rad=*/0.001);
    const Rigid3d before = run.truth[kLast].Inverse() * run.estimate[kLast];
    EXPECT_GT(before.translation.norm(), 100);
    largest_turn = std::max(largest_turn, LogSO3(before.rotation).norm());
    for (const int num_chords : {1, 15}) {
      std::vector<Chord> chords;
      for (int k = 1; k <= num_chords; ++k) {
        chords.push_back(run.TrueChord(0, k * kLast / num_chords, 0.02));
      }
      const auto result = SmoothChain(run.estimate, run.odometry, chords, ChainSmootherOptions());
      ASSERT_TRUE(result.ok()) << result.status() << ", seed " << seed << ", " << num_chords;
      EXPECT_TRUE(result->converged) << "seed " << seed << ", " << num_chords;
      EXPECT_LE(result->iterations, 20);
      EXPECT_LT(result->final_cost, 6 * num_chords);  // 3 in the mean: the chords are true
      EXPECT_LT(Log(run.truth[kLast].Inverse() * result->poses[kLast]).norm(), 0.1);
    }
  }
  EXPECT_GT(largest_turn, M_PI / 2);
}

TEST(ChainSmoother, CountsWhatItsFactorHolds) {
  const DriftingRun run(101, 0.05, 0.01, 1);
  const auto non_zeros = [&](const std::vector<Chord>& chords) {
    const auto result = SmoothChain(run.estimate, run.odometry, chords, ChainSmootherOptions());
    return result.ok() ? result->factor_non_zeros : -1;
  };
  // 100 free poses, each tied to the one before but the first, whose neighbour is fixed.
  const int64_t chain = 100 * 21 + 99 * 36;
  EXPECT_EQ(non_zeros({}), chain);
  // Along the chord 20-60, 39 poses see both its ends while they are eliminated.
  EXPECT_EQ(non_zeros({run.TrueChord(20, 60, 0.1)}), chain + 39 * 36);
  // End to end, the chord changes nothing: the first pose is fixed.
  EXPECT_EQ(non_zeros({run.TrueChord(0, 100, 0.1)}), chain);
}

TEST(ChainSmoother, ReachesTheOptimumFromAnEarlierSolution) {
  const DriftingRun run(200, 0.05, 0.01, 4);
  const std::vector<Chord> first = {run.TrueChord(10, 150, 0.02)};
  const std::vector<Chord> second = {run.TrueChord(10, 150, 0.02), run.TrueChord(60, 190, 0.01)};
  const auto start = SmoothChain(run.estimate, run.odometry, first, ChainSmootherOptions());
  ASSERT_TRUE(start.ok());
  const auto result = SmoothChain(start->poses, run.odometry, second, ChainSmootherOptions());
  ASSERT_TRUE(result.ok());
  EXPECT_LT(LargestDistance(result->poses, BatchOptimum(run, second).poses), 1e-4);
}

TEST(ChainSmoother, WithoutChordsTheChainIsItsOdometry) {
  const DriftingRun run(50, 0.05, 0.01, 5);
  const auto result = SmoothChain(run.truth, run.odometry, {}, ChainSmootherOptions());
  ASSERT_TRUE(result.ok());
  EXPECT_LT(LargestDistance(result->poses, run.estimate), 1e-12);
}

TEST(ChainSmoother, PosesBehindTheLastChordMoveRigidlyWithIt) {
  const DriftingRun run(60, 0.05, 0.01, 6);
  const auto result =
      SmoothChain(run.estimate, run.odometry, {run.TrueChord(5, 40, 0.01)}, ChainSmootherOptions());
  ASSERT_TRUE(result.ok());
  EXPECT_GT(LargestDistance(result->poses, run.estimate), 1e-3);
  for (int i = 41; i < 60; ++i) {
    const Rigid3d step = result->poses[i - 1].Inverse() * result->poses[i];
    EXPECT_LT(Log(step.Inverse() * run.odometry[i].previous_from_this).norm(), 1e-12);
  }
}

// Half a turn away, plain Gauss-Newton overshoots.
TEST(ChainSmoother, TheCostNeverRises) {
  for (int seed = 1; seed <= 20; ++seed) {
    const DriftingRun run(40, 0.3, 0.3, seed);
    const std::vector<Chord> chords = {run.TrueChord(0, 39, 0.05), run.TrueChord(30, 10, 0.05)};
    const auto result = SmoothChain(run.estimate, run.odometry, chords, ChainSmootherOptions());
    ASSERT_TRUE(result.ok()) << result.status() << ", seed " << seed;
    EXPECT_LE(result->final_cost, result->initial_cost);
  }
}

}  // namespace
}  // namespace overtone
