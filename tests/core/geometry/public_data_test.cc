// SPDX-License-Identifier: Apache-2.0
// Published odometry against published ground truth: readers, interpolation, alignment and error
// together must give the figures known for it. The data is read from beside the project and never
// part of it.
#include <cmath>
#include <filesystem>
#include <ostream>
#include <string>

#include "gtest/gtest.h"
#include "overtone/core/geometry/trajectory.h"
#include "overtone/core/geometry/trajectory_error.h"
#include "overtone/core/geometry/trajectory_io.h"

namespace overtone {
namespace {

constexpr char kData[] = OVERTONE_SOURCE_DIR "/../shared/data/";

struct Case {
  std::string name;
  TrajectoryFormat format;
  std::string odometry;
  std::string ground_truth;
  std::string ate_m;   // as printed with the data
  double path_m = -1;  // of the ground truth, where printed
};

void PrintTo(const Case& param, std::ostream* out) { *out << param.name; }

class PublicData : public testing::TestWithParam<Case> {};

// The ground truth at the odometry's stamps; odometry before its first or after its last stamp is
// left out.
struct Pairs {
  std::vector<Rigid3d> odometry;
  std::vector<Rigid3d> truth;
};

Pairs Associate(const Trajectory& odometry, const Trajectory& truth) {
  Pairs pairs;
  for (const StampedPose& pose : odometry) {
    const auto at_stamp = Interpolate(truth, pose.stamp);
    if (!at_stamp.ok()) continue;
    pairs.odometry.push_back(pose.pose);
    pairs.truth.push_back(*at_stamp);
  }
  return pairs;
}

TEST_P(PublicData, HasTheAbsoluteTrajectoryErrorKnownForIt) {
  const Case& param = GetParam();
  if (!std::filesystem::exists(kData + param.odometry)) {
    GTEST_SKIP() << kData << param.odometry << " is not there";
  }
  const auto odometry = ReadTrajectory(kData + param.odometry, param.format);
  const auto truth = ReadTrajectory(kData + param.ground_truth, param.format);
  ASSERT_TRUE(odometry.ok()) << odometry.status();
  ASSERT_TRUE(truth.ok()) << truth.status();
  const Pairs pairs = Associate(*odometry, *truth);
  ASSERT_GT(pairs.odometry.size(), 0.9 * odometry->size());
  const auto full = AbsoluteTrajectoryError(pairs.odometry, pairs.truth, AlignmentMode::kSe3);
  const auto yaw = AbsoluteTrajectoryError(pairs.odometry, pairs.truth, AlignmentMode::kYawOnly);
  ASSERT_TRUE(full.ok()) << full.status();
  ASSERT_TRUE(yaw.ok()) << yaw.status();
  const auto step = RelativePoseError(pairs.odometry, pairs.truth, 10);
  std::printf(
      "%s: %zu of %zu poses, path %.1f m, ATE %.5f m (yaw-only %.5f m), rotation %.2f deg, RPE/10 "
      "%.3f m\n",
      param.name.c_str(), pairs.odometry.size(), odometry->size(), PathLength(*truth), full->rmse_m,
      yaw->rmse_m, full->rotation_rmse_rad * 180 / M_PI, step->translation_rmse_m);

  const int decimals = static_cast<int>(param.ate_m.size() - param.ate_m.find('.') - 1);
  EXPECT_NEAR(full->rmse_m, std::stod(param.ate_m), 0.5 * std::pow(10, -decimals));
  EXPECT_GE(yaw->rmse_m, full->rmse_m) << "fewer freedoms cannot fit better";
  if (param.path_m > 0) {
    EXPECT_NEAR(PathLength(*truth), param.path_m, 0.01 * param.path_m);
  }
}

constexpr TrajectoryFormat kTum = TrajectoryFormat::kTum;
constexpr TrajectoryFormat kKitti = TrajectoryFormat::kKitti;

INSTANTIATE_TEST_SUITE_P(
    , PublicData,
    testing::Values(
        Case{"cppt_MH_01", kTum, "euroc/odometry_cppt/MH_01.txt", "euroc/gt/MH_01.txt", "0.174",
             80.5},
        Case{"cppt_MH_02", kTum, "euroc/odometry_cppt/MH_02.txt", "euroc/gt/MH_02.txt", "0.206",
             73.4},
        Case{"cppt_MH_03", kTum, "euroc/odometry_cppt/MH_03.txt", "euroc/gt/MH_03.txt", "0.211",
             130.7},
        Case{"rpg_MH_01", kTum, "euroc/odometry_rpg_vio_mono/MH_01.txt", "euroc/gt/MH_01.txt",
             "0.204"},
        Case{"rpg_MH_03", kTum, "euroc/odometry_rpg_vio_mono/MH_03.txt", "euroc/gt/MH_03.txt",
             "0.144"},
        Case{"KAIST_01", kKitti, "mulran/odometry/KAIST_01.txt", "mulran/gt/KAIST_01.txt", "13.5"},
        Case{"KAIST_02", kKitti, "mulran/odometry/KAIST_02.txt", "mulran/gt/KAIST_02.txt", "9.7"},
        Case{"KAIST_03", kKitti, "mulran/odometry/KAIST_03.txt", "mulran/gt/KAIST_03.txt", "10.0"},
        Case{"kitti_00", kKitti, "kitti/odometry_simple/00.txt", "kitti/gt/00.txt", "4.86", 3724},
        Case{"kitti_05", kKitti, "kitti/odometry_simple/05.txt", "kitti/gt/05.txt", "2.29", 2206},
        Case{"kitti_07", kKitti, "kitti/odometry_simple/07.txt", "kitti/gt/07.txt", "0.78", 695}),
    [](const testing::TestParamInfo<Case>& info) { return info.param.name; });

}  // namespace
}  // namespace overtone
