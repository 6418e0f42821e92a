// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/dataset.h"

#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/client/cli/g2o_recording.h"
#include "overtone/client/cli/robot_plan.h"

namespace overtone {
namespace {

using ::testing::HasSubstr;

const std::string kData = std::string(OVERTONE_SOURCE_DIR) + "/../shared/data";

std::string WriteTemporary(const std::string& name, const std::string& text) {
  const std::string path = ::testing::TempDir() + std::to_string(getpid()) + "_" + name;
  std::ofstream(path) << text;
  return path;
}

// A straight run along x, 10 Hz, `step` metres a pose.
Recording StraightRun(int poses, double step) {
  Recording recording;
  recording.name = "R";
  recording.id = {"r", "run"};
  for (int i = 0; i < poses; ++i) {
    const Rigid3d pose(Eigen::Quaterniond::Identity(), {i * step, 0, 0});
    recording.odometry.push_back({Timestamp{i * 100'000'000LL}, pose});
    recording.ground_truth.push_back({Timestamp{i * 100'000'000LL}, pose});
    recording.frames.push_back(i);
  }
  return recording;
}

TEST(Dataset, ReadsRobotSources) {
  const auto with = ParseRobotSource("MH_01:a/odometry.txt:gt.txt");
  ASSERT_TRUE(with.ok());
  EXPECT_EQ(with->name, "MH_01");
  EXPECT_EQ(with->odometry_path, "a/odometry.txt");
  EXPECT_EQ(with->ground_truth_path, "gt.txt");
  EXPECT_EQ(ParseRobotSource("MH_01:odometry.txt")->ground_truth_path, "");
  for (const char* text : {"", "MH_01", ":x", "a:", "a:b:c:d"}) {
    EXPECT_EQ(ParseRobotSource(text).status().code(), absl::StatusCode::kInvalidArgument) << text;
  }
}

TEST(Dataset, NamesBecomeIdsInLowerCase) {
  EXPECT_EQ(ToString(*MissionOf("MH_01")), "mh_01/run");
  const auto bad = MissionOf("no spaces");
  EXPECT_THAT(std::string(bad.status().message()), HasSubstr("no spaces"));
}

TEST(Dataset, ErrorsNameFileAndLine) {
  const std::string path = WriteTemporary("bad.tum", "0 0 0 0 0 0 0 1\n1 0 0 nan 0 0 0 1\n");
  const auto recording = ReadRecording(DatasetKind::kTum, {"a", path, ""});
  EXPECT_EQ(recording.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(recording.status().message()), HasSubstr("bad.tum:2"));
  EXPECT_EQ(ReadRecording(DatasetKind::kTum, {"a", "/nowhere.tum", ""}).status().code(),
            absl::StatusCode::kNotFound);
}

TEST(Dataset, PartsOverlapByTheStatedShareAndCoverTheRun) {
  const auto parts = SplitRecording(StraightRun(260, 1), 3, 0.2);  // 3 L - 2 * 0.2 L = 260: L = 100
  ASSERT_TRUE(parts.ok()) << parts.status();
  ASSERT_EQ(parts->size(), 3);
  EXPECT_EQ((*parts)[0].name, "R_0");
  EXPECT_EQ((*parts)[0].frames.front(), 0);
  EXPECT_EQ((*parts)[0].frames.back(), 99);
  EXPECT_EQ((*parts)[1].frames.front(), 80);
  EXPECT_EQ((*parts)[1].frames.back(), 179);
  EXPECT_EQ((*parts)[2].frames.front(), 160);
  EXPECT_EQ((*parts)[2].frames.back(), 259);
  for (const Recording& part : *parts) {
    EXPECT_EQ(part.odometry[0].pose.translation.norm(), 0);
    EXPECT_NEAR(part.odometry[10].pose.translation.x(), 10, 1e-12);
  }
  EXPECT_FALSE(SplitRecording(StraightRun(20, 1), 3, 0.2).ok());
  EXPECT_FALSE(SplitRecording(StraightRun(260, 1), 3, 1).ok());
}

TEST(RobotPlan, KeepsKeyframesAndTheGroundTruthBetweenItsHoles) {
  Recording recording = StraightRun(101, 0.1);
  recording.ground_truth.erase(recording.ground_truth.begin() + 40,
                               recording.ground_truth.begin() + 60);  // 2 s
  const auto plan = MakeRobotPlan(recording, {1, 10}, MotionNoise());
  ASSERT_TRUE(plan.ok()) << plan.status();
  ASSERT_EQ(plan->keyframes.size(), 11);
  EXPECT_NEAR(plan->path_m, 10, 1e-9);
  EXPECT_NEAR(plan->TimeOf(3), 3, 1e-9);
  int known = 0;
  for (const auto& pose : plan->ground_truth) known += pose.has_value();
  EXPECT_EQ(known, 9);  // all but those at 4 s and 5 s
  EXPECT_FALSE(plan->ground_truth[4].has_value());
}

TEST(RobotPlan, VariancesOfARandomWalkAddUpAlongTheWay) {
  MotionNoise noise;
  noise.translation_per_sqrt_m = 0.1;
  const auto plan = MakeRobotPlan(StraightRun(101, 0.1), {1, 10}, noise);
  ASSERT_TRUE(plan.ok());
  // Ten steps of 0.1 m: along the way there is no lever arm, so 0.01 m^2 per metre.
  EXPECT_NEAR(plan->keyframes[5].motion_covariance(0, 0), 0.01, 1e-5);
  EXPECT_GT(plan->keyframes[5].motion_covariance(1, 1), 0.01);  // the heading's share
}

TEST(MotionNoise, CovariancesOfAChainMatchThoseOfSampledChains) {
  const Rigid3d step(ExpSO3({0.1, -0.2, 0.4}), {1, 0.3, -0.2});
  Matrix6d covariance = Matrix6d::Identity() * 1e-8;
  covariance(0, 4) = covariance(4, 0) = 5e-9;
  // (T Exp(a)) (T Exp(b)) to first order: T T Exp(Adj(T^-1) a + b).
  const Matrix6d both = CompoundCovariance(covariance, step, covariance);
  for (int i = 0; i < 6; ++i) {
    const double h = 1e-6;
    const Vector6d moved =
        Log((step * step).Inverse() * (step * Exp(h * Vector6d::Unit(i))) * step);
    const Vector6d expected = Adjoint(step.Inverse()).col(i) * h;
    EXPECT_LT((moved - expected).norm(), 1e-11);
  }
  const Matrix6d adjoint = Adjoint(step.Inverse());
  EXPECT_LT((both - adjoint * covariance * adjoint.transpose() - covariance).norm(), 1e-15);
}

TEST(RobotPlan, AClosureIsCarriedToTheNearestKeyframesByOdometry) {
  const auto plan = MakeRobotPlan(StraightRun(101, 0.1), {1, 10}, MotionNoise());
  ASSERT_TRUE(plan.ok());
  // Between rows 12 (1.2 m) and 58 (5.8 m): keyframes at 1 m and 6 m.
  const Rigid3d measured(Eigen::Quaterniond::Identity(), {4.6, 0, 0});
  const auto placed = PlaceClosure(*plan, 12, *plan, 58, measured, Matrix6d::Identity());
  ASSERT_TRUE(placed.has_value());
  EXPECT_EQ(placed->from.index, 1);
  EXPECT_EQ(placed->to.index, 6);
  EXPECT_NEAR(placed->from_tform_to.translation.x(), 5, 1e-9);
  EXPECT_FALSE(PlaceClosure(*plan, 9, *plan, 11, measured, Matrix6d::Identity()).has_value());
}

TEST(G2oRecording, OdometryIsComposedAndOtherEdgesAreClosures) {
  const std::string path = WriteTemporary("square.g2o",
                                          "VERTEX_SE2 0 5 5 1\n"
                                          "EDGE_SE2 0 1 1 0 0.5 100 0 0 100 0 1000\n"
                                          "EDGE_SE2 1 2 1 0 0.5 100 0 0 100 0 1000\n"
                                          "EDGE_SE2 2 0 -1 0 -1 100 0 0 100 0 1000\n");
  const auto recording = ReadG2oRecording(path);
  ASSERT_TRUE(recording.ok()) << recording.status();
  ASSERT_EQ(recording->odometry.size(), 3);
  EXPECT_EQ(recording->odometry[0].pose.translation.norm(), 0);
  EXPECT_NEAR(recording->odometry[2].pose.translation.x(), 1 + std::cos(0.5), 1e-12);
  EXPECT_NEAR(recording->motion_covariances[1](0, 0), 0.01, 1e-12);
  ASSERT_EQ(recording->closures.size(), 1);
  EXPECT_EQ(recording->closures[0].from_frame, 2);
}

TEST(G2oRecording, AnAlignmentIsTwelveNumbers) {
  const auto pose = ReadAlignment(WriteTemporary("a.txt", "0 -1 0 3\n1 0 0 4\n0 0 1 5\n"));
  ASSERT_TRUE(pose.ok()) << pose.status();
  EXPECT_LT((*pose * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(3, 5, 5)).norm(), 1e-12);
  EXPECT_FALSE(ReadAlignment(WriteTemporary("b.txt", "1 0 0\n")).ok());
  EXPECT_FALSE(ReadAlignment(WriteTemporary("c.txt", "2 0 0 3\n0 1 0 4\n0 0 1 5\n")).ok());
}

// The KITTI graphs are planar; their real loop edges, lifted into the camera's axes, must say what
// the ground truth says.
class KittiPlanarClosures : public ::testing::TestWithParam<std::string> {};

TEST_P(KittiPlanarClosures, AgreeWithTheGroundTruth) {
  const std::string graph = kData + "/kitti/stereo_g2o/kitti_" + GetParam() + ".g2o";
  const std::string truth = kData + "/kitti/gt/" + GetParam() + ".txt";
  if (!std::filesystem::exists(graph)) GTEST_SKIP() << graph << " is not there";
  const auto closures = ReadG2oClosures(graph, /*kitti_camera=*/true);
  ASSERT_TRUE(closures.ok()) << closures.status();
  const auto recording = ReadRecording(DatasetKind::kKitti, {"k", truth, ""});
  ASSERT_TRUE(recording.ok()) << recording.status();
  EXPECT_EQ(closures->size(), GetParam() == "00" ? 136 : 66);
  std::vector<double> ahead, sideways, heading;
  for (const FrameClosure& closure : *closures) {
    const Rigid3d true_pose = recording->odometry[closure.from_frame].pose.Inverse() *
                              recording->odometry[closure.to_frame].pose;
    const Vector6d error = Log(true_pose.Inverse() * closure.from_tform_to);
    ahead.push_back(std::abs(error[2]));
    sideways.push_back(std::abs(error[0]));
    heading.push_back(std::abs(error[4]));
    // Weak across the plane, firm in it.
    EXPECT_GT(closure.covariance(1, 1), 0.9);
    EXPECT_LT(closure.covariance(0, 0), 0.01);
    EXPECT_LT(closure.covariance(2, 2), 0.01);
    EXPECT_LT(closure.covariance(4, 4), 1e-4);
  }
  for (std::vector<double>* errors : {&ahead, &sideways, &heading}) {
    std::nth_element(errors->begin(), errors->begin() + errors->size() / 2, errors->end());
  }
  EXPECT_LT(ahead[ahead.size() / 2], 0.08);
  EXPECT_LT(sideways[sideways.size() / 2], 0.08);
  EXPECT_LT(heading[heading.size() / 2], 0.01);
}

INSTANTIATE_TEST_SUITE_P(Sequences, KittiPlanarClosures, ::testing::Values("00", "05"));

}  // namespace
}  // namespace overtone
