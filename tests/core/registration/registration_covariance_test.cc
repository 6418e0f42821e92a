// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/registration/registration_covariance.h"

#include <cstdio>

#include "Eigen/Eigenvalues"
#include "gtest/gtest.h"
#include "overtone/core/registration/coarse_to_fine.h"
#include "overtone/tests/support/simulated_scans.h"

namespace overtone {
namespace {

RegistrationResult RegisterAtTruth(const ScanPair& pair, const CoarseToFineOptions& options) {
  const auto source = RegistrationPyramid::Create(pair.source, options);
  const auto target = RegistrationPyramid::Create(pair.target, options);
  return *RegisterCoarseToFine(*source, *target, pair.target_from_source, options);
}

// Both scans from nearly the same place, the source turned by `yaw`.
RegistrationResult RegisterIn(const PatchWorld& world, double yaw, const Scanner& scanner,
                              const CoarseToFineOptions& options) {
  return RegisterAtTruth(
      ScanTwice(world, StandingAt(0.3, 0.1, yaw), StandingAt(0, 0, 0), scanner, /*seed=*/1),
      options);
}

// Standard deviation along the world's axis in a source turned by yaw.
double SigmaAlong(const Eigen::Vector3d& world_axis, double yaw, const Matrix6d& covariance) {
  const Eigen::Vector3d axis = ExpSO3(Eigen::Vector3d(0, 0, -yaw)) * world_axis;
  return std::sqrt(axis.dot(covariance.topLeftCorner<3, 3>() * axis));
}

TEST(RegistrationCovariance, OfARoomIsTightInAllDirections) {
  const RegistrationResult result = RegisterIn(RoomWorld(), 0.4, Scanner(), {});
  EXPECT_EQ(result.open_directions, 0);
  EXPECT_LT(std::sqrt(result.covariance.diagonal().maxCoeff()), 0.03);
  EXPECT_GT(std::sqrt(result.covariance.diagonal().minCoeff()), 0.001);
}

TEST(RegistrationCovariance, OfACorridorIsOpenAlongItsAxisOnly) {
  for (const double yaw : {0.0, 0.6}) {
    for (const bool planar : {false, true}) {
      const RegistrationResult result =
          planar ? RegisterIn(CorridorWorld(), yaw, PlanarScanner(), IndoorLaserOptions())
                 : RegisterIn(CorridorWorld(), yaw, Scanner(), {});
      EXPECT_EQ(result.open_directions, 1) << "yaw " << yaw << " planar " << planar;
      EXPECT_GT(SigmaAlong(Eigen::Vector3d::UnitX(), yaw, result.covariance), 50);
      const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(result.covariance);
      const Eigen::Vector3d axis = ExpSO3(Eigen::Vector3d(0, 0, -yaw)) * Eigen::Vector3d::UnitX();
      EXPECT_GT(std::abs(eigen.eigenvectors().col(5).head<3>().dot(axis)), 0.995);
      EXPECT_LT(std::sqrt(eigen.eigenvalues()(4)), 0.1) << "everything else is determined";
    }
  }
}

// The errors of the normals, here of several degrees, do not add up to a hold on the axis.
TEST(RegistrationCovariance, NoiseDoesNotCloseACorridor) {
  Scanner laser = PlanarScanner();
  laser.range_sigma_m = 0.07;
  for (const double yaw : {0.0, 0.3, 0.6, 0.9}) {
    EXPECT_EQ(RegisterIn(CorridorWorld(), yaw, laser, IndoorLaserOptions()).open_directions, 1);
  }
}

TEST(RegistrationCovariance, OfAWallIsOpenAlongItAndAboutItsNormal) {
  const RegistrationResult result = RegisterIn(WallWorld(), 0, Scanner(), {});
  EXPECT_EQ(result.open_directions, 3);
  EXPECT_LT(SigmaAlong(Eigen::Vector3d::UnitX(), 0, result.covariance), 10);
  EXPECT_GT(SigmaAlong(Eigen::Vector3d::UnitY(), 0, result.covariance), 50);
  EXPECT_GT(SigmaAlong(Eigen::Vector3d::UnitZ(), 0, result.covariance), 50);
  const RegistrationResult line = RegisterIn(WallWorld(), 0, PlanarScanner(), IndoorLaserOptions());
  EXPECT_EQ(line.open_directions, 1);
}

// Normalised estimation error squared of repeated registrations of noisy scans, over the degrees of
// freedom: 1 when the covariance is exact, more when it promises too much. The systematic part is
// more than a simulation has, so it is less here; the bound below keeps the covariance of use.
double MeanNees(const Scanner& scanner, const CoarseToFineOptions& options, int pairs) {
  Random random(7);
  double sum = 0;
  for (int i = 0; i < pairs; ++i) {
    const auto pose = [&] {
      return StandingAt(2 * random.Uniform() - 1, 2 * random.Uniform() - 1, 6 * random.Uniform());
    };
    const Rigid3d from = pose(), to = pose();
    const ScanPair pair = ScanTwice(HallWorld(), from, to, scanner, /*seed=*/100 + i);
    const RegistrationResult result = RegisterAtTruth(pair, options);
    const Vector6d error = Log(pair.target_from_source.Inverse() * result.target_from_source);
    EXPECT_EQ(result.open_directions, 0);
    sum += error.dot(result.covariance.inverse() * error);
  }
  const int freedoms = scanner.num_rings == 1 ? 3 : 6;
  std::printf("%d pairs, %d freedoms: NEES per freedom %.3f\n", pairs, freedoms,
              sum / pairs / freedoms);
  return sum / pairs / freedoms;
}

TEST(RegistrationCovariance, PromisesNoMoreThanRepeatedRegistrationsKeep) {
  Scanner lidar;
  lidar.range_sigma_m = 0.05;
  const double solid = MeanNees(lidar, {}, 12);
  EXPECT_LT(solid, 1);
  EXPECT_GT(solid, 0.005);
  Scanner laser = PlanarScanner();
  laser.range_sigma_m = 0.05;
  const double planar = MeanNees(laser, IndoorLaserOptions(), 40);
  EXPECT_LT(planar, 1);
  EXPECT_GT(planar, 0.005);
}

TEST(RegistrationCovariance, FollowsTheBodyFrame) {
  // The same points seen from a body 10 m to the side: its translation is as uncertain as the
  // rotation at 10 m makes it.
  ScanPair pair = ScanTwice(RoomWorld(), StandingAt(0, 0, 0), StandingAt(0.2, 0, 0), Scanner(), 1);
  CoarseToFineOptions options;
  options.covariance.systematic_m = options.covariance.systematic_rad = 1e-9;
  const RegistrationResult near = RegisterAtTruth(pair, options);
  const Rigid3d room_from_body(Eigen::Quaterniond::Identity(), Eigen::Vector3d(0, 10, 0));
  for (Eigen::Vector3f& point : pair.source.points) point.y() -= 10;
  pair.target_from_source = pair.target_from_source * room_from_body;
  const RegistrationResult far = RegisterAtTruth(pair, options);
  const Matrix6d tangent = Adjoint(room_from_body.Inverse());
  const Matrix6d expected = tangent * near.covariance * tangent.transpose();
  const Vector6d sigmas = expected.diagonal().cwiseSqrt();
  const Matrix6d off = (far.covariance - expected).cwiseQuotient(sigmas * sigmas.transpose());
  EXPECT_LT(off.cwiseAbs().maxCoeff(), 0.3) << off;
}

}  // namespace
}  // namespace overtone
