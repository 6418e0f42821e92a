// SPDX-License-Identifier: Apache-2.0
// A pair of LiDAR scans (koide3/small_gicp, data/, MIT) with the transform published with it; read
// from beside the project, never part of it.
#include <filesystem>
#include <fstream>

#include "gtest/gtest.h"
#include "overtone/core/geometry/parse_pose.h"
#include "overtone/core/graph/point_cloud_io.h"
#include "overtone/core/registration/coarse_to_fine.h"

namespace overtone {
namespace {

const std::string kData = OVERTONE_SOURCE_DIR "/../shared/data/registration/";

class RecordedPair : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kData)) GTEST_SKIP() << kData << " is not there";
    source_ = *RegistrationPyramid::Create(*ReadPointCloud(kData + "source.ply"), options_);
    target_ = *RegistrationPyramid::Create(*ReadPointCloud(kData + "target.ply"), options_);
    std::ifstream file(kData + "T_target_source.txt");
    Eigen::Matrix<double, 3, 4> matrix;
    for (int i = 0; i < 12; ++i) file >> matrix(i / 4, i % 4);
    truth_ = *CheckedPose(matrix);
  }

  const CoarseToFineOptions options_{};
  RegistrationPyramid source_, target_;
  Rigid3d truth_;
};

TEST_F(RecordedPair, IsRegisteredToTheTransformPublishedWithIt) {
  const auto result = RegisterCoarseToFine(source_, target_, Rigid3d(), options_);
  ASSERT_TRUE(result.ok()) << result.status();
  const Vector6d error = Log(truth_.Inverse() * result->target_from_source);
  std::printf("%.1f mm, %.2f deg, overlap %.3f, residual %.3f m\n", 1e3 * error.head<3>().norm(),
              error.tail<3>().norm() * 180 / M_PI, result->overlap, result->residual_m);
  EXPECT_LT(error.head<3>().norm(), 0.02);
  EXPECT_LT(error.tail<3>().norm(), 0.5 * M_PI / 180);
  EXPECT_TRUE(result->converged);
  EXPECT_GT(result->overlap, 0.8);
  EXPECT_EQ(result->open_directions, 0);
  // Honest to within 3 sigma, and says something.
  EXPECT_LT(error.dot(result->covariance.inverse() * error), 22.5);
  EXPECT_LT(std::sqrt(result->covariance.diagonal().maxCoeff()), 0.05);
}

TEST_F(RecordedPair, IsFoundFromFiveMetresAndTenDegreesAway) {
  const auto near = RegisterCoarseToFine(source_, target_, truth_, options_);
  for (int i = 0; i < 8; ++i) {
    const double heading = i * M_PI / 4, yaw = (i % 2 == 0 ? 1 : -1) * 10 * M_PI / 180;
    const Rigid3d away(ExpSO3({0, 0, yaw}),
                       5 * Eigen::Vector3d(std::cos(heading), std::sin(heading), 0.1));
    const auto far = RegisterCoarseToFine(source_, target_, truth_ * away, options_);
    EXPECT_LT(Log(near->target_from_source.Inverse() * far->target_from_source).norm(), 0.01)
        << "from heading " << heading;
  }
}

TEST_F(RecordedPair, FarFromEachOtherTheyOverlapLittle) {
  const Rigid3d away(Eigen::Quaterniond::Identity(), Eigen::Vector3d(60, 0, 0));
  const auto result = RegisterCoarseToFine(source_, target_, away * truth_, options_);
  ASSERT_TRUE(result.ok()) << result.status();
  EXPECT_LT(result->overlap, 0.5);
}

}  // namespace
}  // namespace overtone
