// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/observations.h"

#include <fstream>
#include <sstream>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/client/cli/robot_recording_file.h"
#include "overtone/core/graph/point_cloud_io.h"
#include "overtone/tests/client/cli/recording_files.h"

namespace overtone {
namespace {

using ::testing::HasSubstr;

std::shared_ptr<const PointCloud> CloudOf(int points) {
  PointCloud cloud;
  for (int i = 0; i < points; ++i) cloud.points.emplace_back(i, 0.5f, -1);
  return std::make_shared<const PointCloud>(cloud);
}

Eigen::Matrix3d FullCovariance() {
  Eigen::Matrix3d covariance;
  covariance << 4, 1, 0.5, 1, 5, 0.25, 0.5, 0.25, 6;
  return covariance;
}

// At indices 0 to 3, one of each kind.
Observations OneOfEach() {
  Observations observations;
  observations.clouds.push_back({0, "", CloudOf(3)});
  observations.landmark_sightings.push_back({1, "landmark6", {1, 2, 3}, FullCovariance()});
  observations.robot_sightings.push_back({2, "robot2", {4, 5, 6}, FullCovariance()});
  AbsolutePose pose;
  pose.index = 3;
  pose.map_from_body = Rigid3d(ExpSO3({0.1, 0.2, 0.3}), {7, 8, 9});
  pose.covariance = 2 * Matrix6d::Identity();
  observations.absolute_poses.push_back(pose);
  return observations;
}

RobotRecording RecordingOf(const Observations& observations) {
  RobotRecording recording;
  recording.id = {"a", "run"};
  for (int i = 0; i < 4; ++i) {
    Keyframe keyframe;
    keyframe.stamp.ns = i;
    recording.keyframes.push_back(keyframe);
  }
  recording.keyframes[2].degenerate = true;
  recording.keyframes[2].degenerate_direction = Eigen::Vector3d(0, 1, 0);
  recording.candidates.push_back({{{"b", "run"}, 9}, {recording.id, 2}, 0.75});
  recording.observations = observations;
  return recording;
}

TEST(Observations, ARobotGetsThemBackFromItsRecordingWithCloudsInFiles) {
  const TemporaryFolder folder("observations");
  RobotRecording recording = RecordingOf(OneOfEach());
  ASSERT_TRUE(WriteClouds(folder.path() + "/clouds", &recording.observations).ok());
  EXPECT_EQ(recording.observations.clouds[0].cloud, nullptr);
  const std::string path = folder.path() + "/recording.json";
  ASSERT_TRUE(WriteRobotRecording(path, recording).ok());
  const auto again = ReadRobotRecording(path);
  ASSERT_TRUE(again.ok()) << again.status();

  EXPECT_EQ(again->keyframes[2].degenerate_direction, Eigen::Vector3d(0, 1, 0));
  EXPECT_TRUE(again->keyframes[1].degenerate_direction.isZero(0));
  ASSERT_EQ(again->candidates.size(), 1);
  EXPECT_EQ(again->candidates[0].from, recording.candidates[0].from);
  EXPECT_EQ(again->candidates[0].to, recording.candidates[0].to);
  EXPECT_EQ(again->candidates[0].score, 0.75);
  const Observations& seen = again->observations;
  ASSERT_EQ(seen.clouds.size(), 1);
  EXPECT_EQ(ReadPointCloud(seen.clouds[0].path)->points, CloudOf(3)->points);
  ASSERT_EQ(seen.landmark_sightings.size(), 1);
  EXPECT_EQ(seen.landmark_sightings[0].index, 1);
  EXPECT_EQ(seen.landmark_sightings[0].landmark, "landmark6");
  EXPECT_EQ(seen.landmark_sightings[0].point_in_body, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(seen.landmark_sightings[0].covariance, FullCovariance());
  ASSERT_EQ(seen.robot_sightings.size(), 1);
  EXPECT_EQ(seen.robot_sightings[0].robot, "robot2");
  ASSERT_EQ(seen.absolute_poses.size(), 1);
  EXPECT_LT((seen.absolute_poses[0].map_from_body.translation - Eigen::Vector3d(7, 8, 9)).norm(),
            1e-12);
  EXPECT_EQ(seen.absolute_poses[0].covariance, 2 * Matrix6d::Identity());
}

TEST(Observations, ARecordingWithAnIndexBeyondItsKeyframesIsRefusedByName) {
  const TemporaryFolder folder("observations");
  const std::string path = folder.path() + "/recording.json";
  const auto error_of = [&path](const RobotRecording& recording) {
    EXPECT_TRUE(WriteRobotRecording(path, recording).ok());
    return std::string(ReadRobotRecording(path).status().message());
  };
  RobotRecording recording = RecordingOf({});
  EXPECT_EQ(error_of(recording), "");
  recording.observations.clouds.push_back({4, "x.pcd", nullptr});
  EXPECT_THAT(error_of(recording), HasSubstr("recording.json: clouds: no keyframe 4"));
  recording = RecordingOf({});
  recording.observations.robot_sightings.push_back({-1, "b", {1, 2, 3}, FullCovariance()});
  EXPECT_THAT(error_of(recording), HasSubstr("robot_sightings: no keyframe -1"));
  recording = RecordingOf({});
  recording.candidates[0].to.index = 4;
  EXPECT_THAT(error_of(recording), HasSubstr("candidates: no keyframe"));
}

TEST(Observations, ARecordingWithAStampThatIsNoIntegerIsRefused) {
  const TemporaryFolder folder("observations");
  const std::string path = folder.path() + "/recording.json";
  ASSERT_TRUE(WriteRobotRecording(path, RecordingOf({})).ok());
  std::ostringstream file;
  file << std::ifstream(path).rdbuf();
  const std::string text = file.str(), key = "\"stamp_ns\":";
  const size_t begin = text.find(key) + key.size(), end = text.find_first_of(",}", begin);
  for (const std::string stamp : {"1.5", "1e50", "9223372036854775808", "true", "\"1\""}) {
    folder.Write("recording.json", text.substr(0, begin) + stamp + text.substr(end));
    EXPECT_THAT(std::string(ReadRobotRecording(path).status().message()),
                HasSubstr("is not an integer below 2^63"))
        << stamp;
  }
}

TEST(Observations, ASubmapTakesThoseOfItsOwnKeyframes) {
  Submap submap;
  ASSERT_TRUE(AddObservations(OneOfEach(), 1, 3, &submap).ok());
  EXPECT_EQ(submap.clouds.size(), 0);
  EXPECT_EQ(submap.landmark_sightings.size(), 1);
  EXPECT_EQ(submap.robot_sightings.size(), 1);
  EXPECT_EQ(submap.absolute_poses.size(), 0);
}

TEST(Observations, ACloudIsReadWhenItsSubmapIsDueAndAnEmptyOneIsNotSent) {
  const TemporaryFolder folder("observations");
  const std::string full = folder.path() + "/full.pcd", empty = folder.path() + "/empty.pcd";
  ASSERT_TRUE(WritePcd(full, *CloudOf(2)).ok());
  ASSERT_TRUE(WritePcd(empty, *CloudOf(0)).ok());
  Observations observations;
  observations.clouds = {{0, full, nullptr}, {1, empty, nullptr}, {2, "/nowhere.pcd", nullptr}};
  Submap submap;
  ASSERT_TRUE(AddObservations(observations, 0, 2, &submap).ok());
  ASSERT_EQ(submap.clouds.size(), 1);
  EXPECT_EQ(submap.clouds[0].index, 0);
  EXPECT_EQ(submap.clouds[0].cloud->size(), 2);
  const absl::Status missing = AddObservations(observations, 2, 3, &submap);
  EXPECT_EQ(missing.code(), absl::StatusCode::kNotFound);
  EXPECT_THAT(std::string(missing.message()), HasSubstr("/nowhere.pcd"));
}

}  // namespace
}  // namespace overtone
