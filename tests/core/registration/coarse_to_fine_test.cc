// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/registration/coarse_to_fine.h"

#include <limits>

#include "Eigen/Eigenvalues"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/tests/support/simulated_scans.h"

namespace overtone {
namespace {

RegistrationResult Register(const ScanPair& pair, const Rigid3d& guess,
                            const CoarseToFineOptions& options = {}) {
  const auto source = RegistrationPyramid::Create(pair.source, options);
  const auto target = RegistrationPyramid::Create(pair.target, options);
  return *RegisterCoarseToFine(*source, *target, guess, options);
}

Rigid3d Off(double x, double y, double z, double yaw) {
  return Rigid3d(ExpSO3(Eigen::Vector3d(0, 0, yaw)), Eigen::Vector3d(x, y, z));
}

ScanPair HallPair(const Scanner& scanner) {
  return ScanTwice(HallWorld(), StandingAt(2, 1, 0.3), StandingAt(0, 0, 0), scanner, 1);
}

TEST(CoarseToFine, FindsAHallFromMetresAndDegreesAway) {
  const ScanPair pair = HallPair(Scanner());
  const RegistrationResult result = Register(pair, pair.target_from_source * Off(4, -3, 0.3, 0.17));
  const Vector6d error = Log(pair.target_from_source.Inverse() * result.target_from_source);
  EXPECT_LT(error.head<3>().norm(), 0.02);
  EXPECT_LT(error.tail<3>().norm(), 0.005);
  EXPECT_TRUE(result.converged);
  EXPECT_GT(result.overlap, 0.7);
  EXPECT_LT(result.residual_m, 0.1);
  EXPECT_EQ(result.open_directions, 0);
  EXPECT_LT(std::sqrt(result.covariance.diagonal().maxCoeff()), 0.03);
}

TEST(CoarseToFine, TurnedStartsFindWhatTheGuessAloneMisses) {
  const ScanPair pair = HallPair(PlanarScanner());
  const auto num_found = [&](const CoarseToFineOptions& options) {
    int found = 0;
    for (int i = 0; i < 8; ++i) {
      const double heading = i * M_PI / 4, yaw = (i % 2 == 0 ? 1 : -1) * M_PI / 4;
      const Rigid3d away = Off(1.5 * std::cos(heading), 1.5 * std::sin(heading), 0, yaw);
      const RegistrationResult result = Register(pair, pair.target_from_source * away, options);
      found += Log(pair.target_from_source.Inverse() * result.target_from_source).norm() < 0.02;
    }
    return found;
  };
  CoarseToFineOptions options = IndoorLaserOptions();
  EXPECT_EQ(num_found(options), 8);
  options.yaw_offsets_rad.clear();
  EXPECT_LT(num_found(options), 7);
}

TEST(CoarseToFine, HoldsWhatPlanarLasersDoNotSee) {
  const ScanPair pair = HallPair(PlanarScanner());
  const Rigid3d tilted(ExpSO3(Eigen::Vector3d(0.05, -0.1, 0)), Eigen::Vector3d(0, 0, 0.7));
  const Rigid3d guess = Off(1, 0, 0, 0.05) * pair.target_from_source * tilted;
  const RegistrationResult result = Register(pair, guess, IndoorLaserOptions());
  const Rigid3d expected = pair.target_from_source * tilted;
  EXPECT_LT(Log(expected.Inverse() * result.target_from_source).norm(), 0.02);
  EXPECT_EQ(result.open_directions, 0);
  EXPECT_LT(std::sqrt(result.covariance.diagonal().maxCoeff()), 0.05);
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Matrix6d>(result.covariance).eigenvalues()(0), 0);
}

TEST(CoarseToFine, DifferentPlacesOverlapLittle) {
  ScanPair pair = HallPair(Scanner());
  Random random(5);
  pair.source = Scan(CorridorWorld(), StandingAt(0, 0, 0), Scanner(), random);
  const double here = Register(HallPair(Scanner()), pair.target_from_source).overlap;
  EXPECT_LT(Register(pair, Rigid3d()).overlap, here - 0.2);
  EXPECT_EQ(Register(pair, Off(500, 0, 0, 0)).overlap, 0);
}

TEST(CoarseToFine, WithoutCounterpartsEverythingIsOpen) {
  const RegistrationResult result = Register(HallPair(Scanner()), Off(500, 0, 0, 0));
  EXPECT_FALSE(result.converged);
  EXPECT_EQ(result.open_directions, 6);
  EXPECT_EQ(result.target_from_source.translation.x(), 500);
  EXPECT_GT(result.covariance.diagonal().minCoeff(), 1);
  EXPECT_TRUE(std::isinf(result.residual_m));
}

TEST(CoarseToFine, RefusesAGuessThatIsNotFiniteAndPyramidsOfOtherOptions) {
  const ScanPair pair = HallPair(Scanner());
  const auto pyramid = RegistrationPyramid::Create(pair.source, {});
  ASSERT_TRUE(pyramid.ok()) << pyramid.status();
  const Rigid3d nowhere = Off(std::numeric_limits<double>::quiet_NaN(), 0, 0, 0);
  EXPECT_THAT(RegisterCoarseToFine(*pyramid, *pyramid, nowhere, {}).status().message(),
              testing::HasSubstr("guess"));
  EXPECT_THAT(RegisterCoarseToFine(*pyramid, *pyramid, {}, IndoorLaserOptions()).status().message(),
              testing::HasSubstr("voxel_sizes_m"));
}

TEST(CoarseToFine, RefusesCloudsWithoutPoints) {
  EXPECT_EQ(RegistrationPyramid::Create(PointCloud(), {}).status().code(),
            absl::StatusCode::kInvalidArgument);
}

TEST(CoarseToFine, OptionsNameTheMemberThatIsNotValid) {
  EXPECT_TRUE(CoarseToFineOptions().Validate().ok());
  EXPECT_TRUE(IndoorLaserOptions().Validate().ok());
  CoarseToFineOptions options;
  options.voxel_sizes_m = {0.5, 0.5};
  EXPECT_THAT(options.Validate().message(), testing::HasSubstr("voxel_sizes_m"));
  options = {};
  options.yaw_offsets_rad = {std::numeric_limits<double>::infinity()};
  EXPECT_THAT(options.Validate().message(), testing::HasSubstr("yaw_offsets_rad"));
  options = {};
  options.covariance.min_share = 0;
  EXPECT_THAT(options.Validate().message(), testing::HasSubstr("min_share"));
  options = {};
  options.overlap_distance = -1;
  EXPECT_THAT(options.Validate().message(), testing::HasSubstr("overlap_distance"));
}

}  // namespace
}  // namespace overtone
