// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/estimation/point_sighting_error.h"

#include "gtest/gtest.h"
#include "overtone/core/estimation/square_root_information.h"
#include "overtone/tests/core/estimation/pose_graph_test_support.h"

namespace overtone {
namespace {

Eigen::Vector3d RandomPoint(std::mt19937& random) { return RandomVector(random, 3).head<3>(); }

Eigen::Matrix3d RandomPointInformation(std::mt19937& random) {
  return RandomInformation(random).topLeftCorner<3, 3>();
}

struct PoseBlock {
  explicit PoseBlock(const Rigid3d& pose) { WritePoseBlock(pose, values); }
  double values[kPoseBlockSize];
};

Eigen::Vector3d Residual(const ceres::CostFunction& error, const double* a, const double* b) {
  const double* blocks[] = {a, b};
  Eigen::Vector3d residual;
  EXPECT_TRUE(error.Evaluate(blocks, residual.data(), nullptr));
  return residual;
}

// Central differences along right perturbations of a pose against its lifted Jacobian.
template <typename ResidualAt>
void ExpectPoseJacobian(const double* jacobian, const Rigid3d& pose,
                        const ResidualAt& residual_at) {
  const Eigen::Map<const Eigen::Matrix<double, 3, kPoseBlockSize, Eigen::RowMajor>> analytic(
      jacobian);
  EXPECT_EQ(analytic.col(6), Eigen::Vector3d::Zero());
  constexpr double kStep = 1e-6;
  for (int k = 0; k < 6; ++k) {
    const PoseBlock ahead(pose * Exp(kStep * Vector6d::Unit(k)));
    const PoseBlock behind(pose * Exp(-kStep * Vector6d::Unit(k)));
    const Eigen::Vector3d numeric =
        (residual_at(ahead.values) - residual_at(behind.values)) / (2 * kStep);
    EXPECT_LT((analytic.col(k) - numeric).norm(), 1e-6 * (1 + numeric.norm())) << "column " << k;
  }
}

TEST(SquareRootInformation, WeightsAPointsErrorByTheFullInformationMatrix) {
  std::mt19937 random(1);
  const Eigen::Matrix3d information = RandomPointInformation(random);
  const Eigen::Vector3d e = RandomPoint(random);
  EXPECT_NEAR((*SquareRootInformation(information) * e).squaredNorm(), e.dot(information * e),
              1e-9 * e.dot(information * e));
}

TEST(SquareRootInformation, ThereIsNoneWhoseFactorOverflows) {
  Eigen::Matrix3d information = Eigen::Matrix3d::Identity();
  information(0, 0) = 1e-10;
  information(0, 2) = information(2, 0) = 1e306;
  EXPECT_FALSE(SquareRootInformation(information).ok());
}

TEST(LandmarkSightingError, IsTheErrorInTheObserversAxesWeightedByTheFullInformation) {
  std::mt19937 random(2);
  const PoseBlock pose(RandomPose(random));
  const Eigen::Vector3d seen = RandomPoint(random), e = RandomPoint(random);
  const Eigen::Matrix3d information = RandomPointInformation(random);
  const LandmarkSightingError error(seen, *SquareRootInformation(information));
  const Eigen::Vector3d exact = ReadPoseBlock(pose.values) * seen;
  const Eigen::Vector3d off = ReadPoseBlock(pose.values) * (seen + e);
  EXPECT_LT(Residual(error, pose.values, exact.data()).norm(), 1e-12);
  EXPECT_NEAR(Residual(error, pose.values, off.data()).squaredNorm(), e.dot(information * e),
              1e-9 * e.dot(information * e));
}

TEST(LandmarkSightingError, JacobiansAreTheDerivatives) {
  std::mt19937 random(3);
  const Rigid3d pose = RandomPose(random);
  const PoseBlock block(pose);
  const Eigen::Vector3d landmark = RandomPoint(random);
  const LandmarkSightingError error(RandomPoint(random),
                                    *SquareRootInformation(RandomPointInformation(random)));
  const double* parameters[] = {block.values, landmark.data()};
  double by_pose[3 * kPoseBlockSize];
  Eigen::Matrix<double, 3, 3, Eigen::RowMajor> by_landmark;
  double* jacobians[] = {by_pose, by_landmark.data()};
  Eigen::Vector3d residual;
  ASSERT_TRUE(error.Evaluate(parameters, residual.data(), jacobians));
  ExpectPoseJacobian(by_pose, pose,
                     [&](const double* at) { return Residual(error, at, landmark.data()); });
  // The residual is linear in the landmark.
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d moved = landmark + Eigen::Vector3d::Unit(k);
    EXPECT_LT((Residual(error, block.values, moved.data()) - residual - by_landmark.col(k)).norm(),
              1e-9);
  }
}

TEST(CarriedPointSightingError, IsTheErrorInTheObserversAxesWeightedByTheFullInformation) {
  std::mt19937 random(4);
  const Rigid3d target = RandomPose(random);
  const PoseBlock observer(RandomPose(random)), carrier(target);
  const Eigen::Vector3d tag = RandomPoint(random), e = RandomPoint(random);
  const Eigen::Vector3d exact = ReadPoseBlock(observer.values).Inverse() * (target * tag);
  const Eigen::Matrix3d information = RandomPointInformation(random);
  const CarriedPointSightingError error(exact - e, tag, *SquareRootInformation(information));
  EXPECT_NEAR(Residual(error, observer.values, carrier.values).squaredNorm(),
              e.dot(information * e), 1e-9 * e.dot(information * e));
}

TEST(CarriedPointSightingError, JacobiansAreTheDerivativesAlongThePerturbations) {
  std::mt19937 random(5);
  const Rigid3d observer = RandomPose(random), carrier = RandomPose(random);
  const PoseBlock observer_block(observer), carrier_block(carrier);
  const CarriedPointSightingError error(RandomPoint(random), RandomPoint(random),
                                        *SquareRootInformation(RandomPointInformation(random)));
  const double* parameters[] = {observer_block.values, carrier_block.values};
  double by_observer[3 * kPoseBlockSize], by_carrier[3 * kPoseBlockSize];
  double* jacobians[] = {by_observer, by_carrier};
  Eigen::Vector3d residual;
  ASSERT_TRUE(error.Evaluate(parameters, residual.data(), jacobians));
  ExpectPoseJacobian(by_observer, observer,
                     [&](const double* at) { return Residual(error, at, carrier_block.values); });
  ExpectPoseJacobian(by_carrier, carrier,
                     [&](const double* at) { return Residual(error, observer_block.values, at); });
}

}  // namespace
}  // namespace overtone
