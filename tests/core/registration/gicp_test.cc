// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/registration/gicp.h"

#include "Eigen/LU"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/core/registration/overlap.h"
#include "overtone/core/registration/surface_information.h"
#include "overtone/tests/support/simulated_scans.h"

namespace overtone {
namespace {

using Cloud = std::shared_ptr<const RegistrationCloud>;

Cloud Prepare(const PointCloud& cloud) {
  RegistrationCloudOptions options;
  options.voxel_size_m = 0.2;
  return *RegistrationCloud::Create(cloud.points, options);
}

PointCloud Moved(const Rigid3d& moved_from_cloud, PointCloud cloud) {
  for (Eigen::Vector3f& point : cloud.points) {
    point = (moved_from_cloud * point.cast<double>().eval()).cast<float>();
  }
  return cloud;
}

ScanPair HallPair(const Scanner& scanner = Scanner()) {
  return ScanTwice(HallWorld(), StandingAt(0.4, -0.3, 0.1), StandingAt(0, 0, 0), scanner, 1);
}

double AngleTo(const Rigid3d& a, const Rigid3d& b) {
  return LogSO3(a.rotation.conjugate() * b.rotation).norm();
}

TEST(SurfaceInformation, IsTheInverseOfTheSummedCovariances) {
  Random random(3);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d n = random.Normal3().normalized(), m = random.Normal3().normalized();
    const auto covariance = [](const Eigen::Vector3d& v) -> Eigen::Matrix3d {
      return Eigen::Matrix3d::Identity() - (1 - kSurfaceEpsilon) * v * v.transpose();
    };
    const Eigen::Matrix3d expected =
        2 * kSurfaceEpsilon * (covariance(n) + covariance(m)).inverse();
    EXPECT_TRUE(SurfaceInformation(n, m).isApprox(expected, 1e-9));
    EXPECT_TRUE(SurfaceInformation(n, -m).isApprox(expected, 1e-9));
  }
  EXPECT_NEAR(SurfaceInformation({0, 0, 1}, {0, 0, -1})(2, 2), 1, 1e-12);
}

TEST(Gicp, GivesTheMotionBetweenACloudAndItsMovedSelf) {
  Vector6d xi;
  xi << 0.2, -0.15, 0.05, 0.01, -0.02, 0.05;
  const Rigid3d target_from_source = Exp(xi);
  const PointCloud cloud = HallPair().source;
  const GicpEstimate estimate =
      Gicp(*Prepare(cloud), *Prepare(Moved(target_from_source, cloud)), Rigid3d(), {});
  EXPECT_TRUE(estimate.converged);
  EXPECT_LT((estimate.target_from_source.translation - xi.head<3>()).norm(), 0.02);
  EXPECT_LT(AngleTo(estimate.target_from_source, target_from_source), 0.002);
}

TEST(Gicp, StaysWhereACloudAlreadyLiesOnItself) {
  const Cloud cloud = Prepare(HallPair().source);
  const GicpEstimate estimate = Gicp(*cloud, *cloud, Rigid3d(), {});
  EXPECT_TRUE(estimate.converged);
  EXPECT_EQ(estimate.iterations, 1);
  EXPECT_LT(Log(estimate.target_from_source).norm(), 1e-6);
}

TEST(Gicp, SwappingTheCloudsInvertsTheMotion) {
  const ScanPair pair = HallPair();
  const Cloud source = Prepare(pair.source), target = Prepare(pair.target);
  const GicpEstimate there = Gicp(*source, *target, Rigid3d(), {});
  const GicpEstimate back = Gicp(*target, *source, Rigid3d(), {});
  const Rigid3d loop = there.target_from_source * back.target_from_source;
  EXPECT_LT(loop.translation.norm(), 0.01);
  EXPECT_LT(LogSO3(loop.rotation).norm(), 0.002);
  EXPECT_LT((there.target_from_source.translation - pair.target_from_source.translation).norm(),
            0.02);
}

TEST(Gicp, EstimatesOnlyXYAndYawOfPlanarClouds) {
  const ScanPair pair = HallPair(PlanarScanner());
  const Cloud source = Prepare(pair.source), target = Prepare(pair.target);
  ASSERT_TRUE(source->planar() && target->planar());
  const GicpEstimate estimate = Gicp(*source, *target, Rigid3d(), {});
  const Vector6d error = Log(pair.target_from_source.Inverse() * estimate.target_from_source);
  EXPECT_TRUE(estimate.converged);
  EXPECT_LT(error.head<2>().norm(), 0.01);
  EXPECT_LT(std::abs(error(5)), 0.002);
  EXPECT_EQ(estimate.target_from_source.translation.z(), 0);
  EXPECT_EQ(estimate.target_from_source.rotation.x(), 0);
}

TEST(Gicp, LeavesTheGuessAloneWithoutCounterparts) {
  const Cloud cloud = Prepare(HallPair().source);
  const Rigid3d far(Eigen::Quaterniond::Identity(), Eigen::Vector3d(1000, 0, 0));
  const GicpEstimate estimate = Gicp(*cloud, *cloud, far, {});
  EXPECT_FALSE(estimate.converged);
  EXPECT_EQ(estimate.target_from_source.translation, far.translation);
  EXPECT_EQ(Overlap(*cloud, *cloud, far, 0.5), 0);
}

TEST(Gicp, OptionsNameTheMemberThatIsNotValid) {
  EXPECT_TRUE(GicpOptions().Validate().ok());
  GicpOptions options;
  options.kernel_width_m = 0;
  EXPECT_THAT(options.Validate().message(), testing::HasSubstr("kernel_width_m"));
  options = {};
  options.max_iterations = 0;
  EXPECT_THAT(options.Validate().message(), testing::HasSubstr("max_iterations"));
}

TEST(Overlap, IsTheShareOfTheSmallerCloudInEitherOrder) {
  const PointCloud whole = HallPair().source;
  PointCloud half;
  for (const Eigen::Vector3f& point : whole.points) {
    if (point.x() > 0) half.points.push_back(point);
  }
  const Rigid3d away(Eigen::Quaterniond::Identity(), Eigen::Vector3d(-4, 0, 0));
  const Cloud large = Prepare(whole), small = Prepare(half);
  EXPECT_EQ(Overlap(*small, *large, Rigid3d(), 0.1), 1);
  EXPECT_EQ(Overlap(*large, *small, Rigid3d(), 0.1), 1);
  const double shifted = Overlap(*small, *large, away, 0.3);
  EXPECT_EQ(Overlap(*large, *small, away.Inverse(), 0.3), shifted);
  EXPECT_GT(shifted, 0.1);
  EXPECT_LT(shifted, 0.6);
}

}  // namespace
}  // namespace overtone
