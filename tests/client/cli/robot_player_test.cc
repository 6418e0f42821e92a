// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/robot_player.h"

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/tests/support/scripted_mapping_server.h"
#include "overtone/tests/support/temporary_directory.h"

namespace overtone {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Upload = ScriptedMappingServer::Upload;

// One keyframe a second, a metre apart.
RobotRecording StraightRecording(int keyframes) {
  RobotRecording recording;
  recording.id = {"a", "run"};
  for (int i = 0; i < keyframes; ++i) {
    Keyframe keyframe;
    keyframe.stamp.ns = i * 1'000'000'000LL;
    keyframe.mission_from_body = Rigid3d(Eigen::Quaterniond::Identity(), {1.0 * i, 0, 0});
    recording.keyframes.push_back(keyframe);
  }
  return recording;
}

class RobotPlayerTest : public ::testing::Test {
 protected:
  RobotPlayerTest()
      : server_({[](int call, Upload& upload) {
                   upload.Ready(call);  // a submap for each run
                   return upload.AcknowledgeEverything();
                 },
                 {},
                 {}}) {}

  absl::StatusOr<std::unique_ptr<RobotPlayer>> Play(const RobotRecording& recording,
                                                    const std::string& outbox = "") {
    MappingClientOptions options;
    options.server = server_.address();
    options.map = "town";
    options.outbox_dir = outbox;
    return RobotPlayer::Create(recording, options, absl::Seconds(20));
  }

  ScriptedMappingServer server_;
};

TEST_F(RobotPlayerTest, ManySightingsMakeShortSubmaps) {
  RobotRecording recording = StraightRecording(5);
  for (int i = 0; i < 5 * 500; ++i) {
    recording.observations.landmark_sightings.push_back(
        {i / 500, "landmark6", {1, 2, 3}, Eigen::Matrix3d::Identity()});
  }
  const auto player = Play(recording);
  ASSERT_TRUE(player.ok()) << player.status();
  const auto answer = (*player)->Advance(3);
  ASSERT_TRUE(answer.ok()) << answer.status();
  EXPECT_EQ(answer->at("keyframes"), 4);  // 1500 sightings from the first three
  EXPECT_THAT(server_.Received(), ElementsAre(0, 1));
  ASSERT_TRUE((*player)->Advance(4).ok());
  EXPECT_THAT(server_.Received(), ElementsAre(0, 1, 2));
}

TEST_F(RobotPlayerTest, ACloudThatIsGoneIsNamedWhenItsSubmapIsDue) {
  RobotRecording recording = StraightRecording(3);
  recording.observations.clouds.push_back({2, "/nowhere.pcd", nullptr});
  const auto player = Play(recording);
  ASSERT_TRUE(player.ok()) << player.status();
  EXPECT_TRUE((*player)->Advance(1).ok());
  const auto answer = (*player)->Advance(2);
  EXPECT_EQ(answer.status().code(), absl::StatusCode::kNotFound);
  EXPECT_THAT(std::string(answer.status().message()), HasSubstr("/nowhere.pcd"));
}

TEST_F(RobotPlayerTest, WithAnOutboxAnotherProcessGoesOn) {
  const TemporaryDirectory directory;
  const RobotRecording recording = StraightRecording(10);
  {
    const auto player = Play(recording, directory.path());
    ASSERT_TRUE(player.ok()) << player.status();
    ASSERT_TRUE((*player)->Advance(3).ok());
  }
  const auto player = Play(recording, directory.path());
  ASSERT_TRUE(player.ok()) << player.status();
  const auto answer = (*player)->Advance(9);
  ASSERT_TRUE(answer.ok()) << answer.status();
  EXPECT_EQ(answer->at("keyframes"), 10);
  EXPECT_THAT(server_.Received(), ElementsAre(0, 1));
}

}  // namespace
}  // namespace overtone
