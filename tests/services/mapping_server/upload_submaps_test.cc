// SPDX-License-Identifier: Apache-2.0
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/tests/services/mapping_server/server_fixture.h"

namespace overtone {
namespace {

using ::testing::HasSubstr;
using testing::MakeClosure;
using testing::MakeSubmap;
using testing::ServerTest;
using ::testing::StartsWith;
using testing::Uploader;

const MissionId kMission = {"anna", "run1"};

class UploadSubmapsTest : public ServerTest {};

TEST_F(UploadSubmapsTest, SubmapsInOrderAreAcknowledgedAndTheNextStreamGoesOnBehindThem) {
  {
    Uploader uploader(*mapping_, "mine", kMission);
    const auto ready = uploader.Read();
    EXPECT_EQ(ready.ready().next_sequence(), 0);
    EXPECT_EQ(ready.ready().window_bytes(), 4 << 20);
    EXPECT_EQ(uploader.Send(MakeSubmap(0, 0, 10)).ack().durable_through_sequence(), 0);
    EXPECT_EQ(uploader.Send(MakeSubmap(1, 10, 5)).ack().durable_through_sequence(), 1);
    EXPECT_TRUE(uploader.Close().ok());
  }
  EXPECT_EQ(UploadState("mine", kMission).next_sequence(), 2);
  EXPECT_EQ(UploadState("mine", kMission).next_index(), 15);
  Uploader uploader(*mapping_, "mine", kMission);
  EXPECT_EQ(uploader.Read().ready().next_sequence(), 2);
}

TEST_F(UploadSubmapsTest, AMissionThatDoesNotExistExpectsSequenceZero) {
  EXPECT_EQ(UploadState("nowhere", kMission).next_sequence(), 0);
  EXPECT_EQ(UploadState("nowhere", kMission).next_index(), 0);
}

TEST_F(UploadSubmapsTest, TheSameSubmapAgainIsAcknowledgedAndStoredOnce) {
  Uploader uploader(*mapping_, "mine", kMission);
  uploader.Read();
  uploader.Send(MakeSubmap(0, 0, 10));
  uploader.Send(MakeSubmap(1, 10, 10));
  EXPECT_EQ(uploader.Send(MakeSubmap(0, 0, 10)).ack().durable_through_sequence(), 1);
  EXPECT_EQ(UploadState("mine", kMission).next_index(), 20);
  EXPECT_EQ(WaitForNodes("mine", 20).NumNodes(), 20);
}

TEST_F(UploadSubmapsTest, OtherContentUnderAStoredSequenceIsAlreadyExists) {
  Uploader uploader(*mapping_, "mine", kMission);
  uploader.Read();
  uploader.Send(MakeSubmap(0, 0, 10));
  Submap other = MakeSubmap(0, 0, 10);
  other.keyframes[3].degenerate = true;
  const auto answer = uploader.Send(other);
  EXPECT_EQ(answer.reject().code(), static_cast<int>(absl::StatusCode::kAlreadyExists));
  EXPECT_EQ(answer.reject().sequence(), 0);
  EXPECT_EQ(uploader.Send(MakeSubmap(1, 10, 5)).ack().durable_through_sequence(), 1);
}

TEST_F(UploadSubmapsTest, AGapIsOutOfRangeWithTheExpectedSequence) {
  Uploader uploader(*mapping_, "mine", kMission);
  uploader.Read();
  uploader.Send(MakeSubmap(0, 0, 10));
  const auto answer = uploader.Send(MakeSubmap(2, 20, 10));
  EXPECT_EQ(answer.reject().code(), static_cast<int>(absl::StatusCode::kOutOfRange));
  EXPECT_EQ(answer.reject().expected_sequence(), 1);
  EXPECT_EQ(uploader.Send(MakeSubmap(1, 10, 10)).ack().durable_through_sequence(), 1);
}

TEST_F(UploadSubmapsTest, ARefusedFirstSubmapBringsNoMapIntoBeing) {
  Uploader uploader(*mapping_, "mine", kMission);
  uploader.Read();
  EXPECT_TRUE(uploader.Send(MakeSubmap(5, 50, 10)).has_reject());
  v1::ListMapsResponse response;
  grpc::ClientContext context;
  ASSERT_TRUE(admin_->ListMaps(&context, {}, &response).ok());
  EXPECT_EQ(response.maps_size(), 0);
}

struct BadSubmap {
  std::string message;  // how the rejection begins
  std::function<void(v1::Submap&)> spoil;
};

std::vector<BadSubmap> BadSubmaps() {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  const auto pose = [](v1::Submap& s) {
    return s.mutable_keyframes(3)->mutable_mission_tform_body();
  };
  const auto covariance = [](v1::Submap& s) {
    return s.mutable_keyframes(3)->mutable_motion_covariance();
  };
  return {
      {"submap.sequence:", [](auto& s) { s.set_sequence(-1); }},
      {"submap.first_index:", [](auto& s) { s.set_first_index(9); }},
      {"submap.first_index:", [](auto& s) { s.set_first_index(11); }},
      {"submap.first_index:", [](auto& s) { s.set_first_index(INT64_MAX); }},
      {"submap.keyframes:", [](auto& s) { s.clear_keyframes(); }},
      {"submap.keyframes:",
       [](auto& s) {
         while (s.keyframes_size() <= 2000) s.add_keyframes();
       }},
      {"submap.keyframes[0].stamp_ns:", [](auto& s) { s.mutable_keyframes(0)->set_stamp_ns(5); }},
      {"submap.keyframes[3].stamp_ns:",
       [](auto& s) { s.mutable_keyframes(3)->set_stamp_ns(s.keyframes(2).stamp_ns()); }},
      {"submap.keyframes[3].stamp_ns:", [](auto& s) { s.mutable_keyframes(3)->set_stamp_ns(-1); }},
      {"submap.keyframes[3].stamp_ns:",
       [](auto& s) { s.mutable_keyframes(3)->set_stamp_ns(INT64_MAX); }},
      {"submap.keyframes[3].mission_tform_body.position.x:",
       [=](auto& s) { pose(s)->mutable_position()->set_x(nan); }},
      {"submap.keyframes[3].mission_tform_body.position.y:",
       [=](auto& s) { pose(s)->mutable_position()->set_y(-inf); }},
      {"submap.keyframes[3].mission_tform_body.position.z:",
       [=](auto& s) { pose(s)->mutable_position()->set_z(1.1e7); }},
      {"submap.keyframes[3].mission_tform_body.position:",
       [=](auto& s) { pose(s)->clear_position(); }},
      {"submap.keyframes[3].mission_tform_body.orientation:",
       [=](auto& s) { pose(s)->clear_orientation(); }},
      {"submap.keyframes[3].mission_tform_body.orientation:",
       [=](auto& s) { pose(s)->mutable_orientation()->set_w(nan); }},
      {"submap.keyframes[3].mission_tform_body.orientation:",
       [=](auto& s) { pose(s)->mutable_orientation()->set_w(2); }},
      {"submap.keyframes[3].mission_tform_body.orientation:",
       [=](auto& s) { pose(s)->mutable_orientation()->Clear(); }},
      {"submap.keyframes[3].motion_covariance:",
       [](auto& s) { s.mutable_keyframes(3)->clear_motion_covariance(); }},
      {"submap.keyframes[3].motion_covariance.upper_triangle:",
       [=](auto& s) { covariance(s)->mutable_upper_triangle()->RemoveLast(); }},
      {"submap.keyframes[3].motion_covariance.upper_triangle:",
       [=](auto& s) { covariance(s)->add_upper_triangle(1); }},
      {"submap.keyframes[3].motion_covariance.upper_triangle[7]:",
       [=](auto& s) { covariance(s)->set_upper_triangle(7, inf); }},
      {"submap.keyframes[3].motion_covariance.upper_triangle:",
       [=](auto& s) { covariance(s)->set_upper_triangle(0, -1); }},
      {"submap.keyframes[3].motion_covariance.upper_triangle:",
       [=](auto& s) { covariance(s)->set_upper_triangle(0, 0); }},
      {"submap.keyframes[3].motion_covariance.upper_triangle:",
       [=](auto& s) { covariance(s)->set_upper_triangle(1, 1); }},
      {"submap.loop_closures[0].from.mission.robot:",
       [](auto& s) {
         s.mutable_loop_closures(0)->mutable_from()->mutable_mission()->set_robot("A");
       }},
      {"submap.loop_closures[0].from.index:",
       [](auto& s) { s.mutable_loop_closures(0)->mutable_from()->set_index(-1); }},
      {"submap.loop_closures[0].to:",
       [](auto& s) { *s.mutable_loop_closures(0)->mutable_to() = s.loop_closures(0).from(); }},
      {"submap.loop_closures[0].from:",
       [](auto& s) {
         s.mutable_loop_closures(0)->mutable_from()->mutable_mission()->set_robot("x");
         s.mutable_loop_closures(0)->mutable_to()->mutable_mission()->set_robot("y");
       }},
      {"submap.loop_closures[0].from_tform_to.position:",
       [](auto& s) { s.mutable_loop_closures(0)->clear_from_tform_to(); }},
      {"submap.loop_closures[0].covariance.upper_triangle:",
       [](auto& s) { s.mutable_loop_closures(0)->clear_covariance(); }},
      {"submap.loop_closures:",
       [](auto& s) {
         while (s.loop_closures_size() <= 2000) s.add_loop_closures();
       }},
  };
}

// Of what lies beside keyframes and closures.
std::vector<BadSubmap> BadBelongings() {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto keyframe = [](v1::Submap& s) { return s.mutable_keyframes(3); };
  const auto candidate = [](v1::Submap& s) { return s.mutable_candidates(0); };
  const auto cloud = [](v1::Submap& s) { return s.mutable_clouds(0); };
  const auto landmark = [](v1::Submap& s) { return s.mutable_landmark_sightings(0); };
  const auto robot = [](v1::Submap& s) { return s.mutable_robot_sightings(0); };
  const auto pose = [](v1::Submap& s) { return s.mutable_absolute_poses(0); };
  const auto fill = [](auto* messages, int count) {
    while (messages->size() < count) messages->Add();
  };
  return {
      {"submap.keyframes[3].degenerate_direction:",
       [=](auto& s) { keyframe(s)->set_degenerate(false); }},
      {"submap.keyframes[3].degenerate_direction:",
       [=](auto& s) { keyframe(s)->mutable_degenerate_direction()->set_x(0.61); }},
      {"submap.keyframes[3].degenerate_direction:",
       [=](auto& s) { keyframe(s)->mutable_degenerate_direction()->Clear(); }},
      {"submap.keyframes[3].degenerate_direction:",
       [=](auto& s) { keyframe(s)->mutable_degenerate_direction()->set_y(nan); }},
      {"submap.candidates[0].from.index:",
       [=](auto& s) { candidate(s)->mutable_from()->set_index(-1); }},
      {"submap.candidates[0].to:",
       [=](auto& s) { *candidate(s)->mutable_to() = candidate(s)->from(); }},
      {"submap.candidates[0].from:",
       [=](auto& s) { candidate(s)->mutable_from()->mutable_mission()->set_robot("carl"); }},
      {"submap.candidates[0].score:", [=](auto& s) { candidate(s)->set_score(1.01); }},
      {"submap.candidates[0].score:", [=](auto& s) { candidate(s)->set_score(-0.01); }},
      {"submap.candidates[0].score:", [=](auto& s) { candidate(s)->set_score(nan); }},
      {"submap.candidates:", [=](auto& s) { fill(s.mutable_candidates(), 2001); }},
      {"submap.clouds[0].index:", [=](auto& s) { cloud(s)->set_index(9); }},
      {"submap.clouds[0].index:", [=](auto& s) { cloud(s)->set_index(15); }},
      {"submap.clouds[1].index:", [=](auto& s) { *s.add_clouds() = *cloud(s); }},
      {"submap.clouds[0].sha256:", [=](auto& s) { cloud(s)->clear_sha256(); }},
      {"submap.clouds[0].sha256:", [=](auto& s) { cloud(s)->set_sha256(std::string(33, 'c')); }},
      {"submap.clouds[0].encoded_bytes:", [=](auto& s) { cloud(s)->set_encoded_bytes(0); }},
      {"submap.clouds[0].encoded_bytes:",
       [=](auto& s) { cloud(s)->set_encoded_bytes((16 << 20) + 1); }},
      {"submap.clouds:", [=](auto& s) { fill(s.mutable_clouds(), 2001); }},
      {"submap.landmark_sightings[0].index:", [=](auto& s) { landmark(s)->set_index(9); }},
      {"submap.landmark_sightings[0].landmark:", [=](auto& s) { landmark(s)->set_landmark("A"); }},
      {"submap.landmark_sightings[0].landmark:", [=](auto& s) { landmark(s)->clear_landmark(); }},
      {"submap.landmark_sightings[0].point_in_body:",
       [=](auto& s) { landmark(s)->clear_point_in_body(); }},
      {"submap.landmark_sightings[0].point_in_body.y:",
       [=](auto& s) { landmark(s)->mutable_point_in_body()->set_y(nan); }},
      {"submap.landmark_sightings[0].point_in_body.z:",
       [=](auto& s) { landmark(s)->mutable_point_in_body()->set_z(1.1e7); }},
      {"submap.landmark_sightings[0].covariance.upper_triangle:",
       [=](auto& s) { landmark(s)->clear_covariance(); }},
      {"submap.landmark_sightings[0].covariance.upper_triangle[1]:",
       [=](auto& s) { landmark(s)->mutable_covariance()->set_upper_triangle(1, nan); }},
      {"submap.landmark_sightings[0].covariance.upper_triangle:",
       [=](auto& s) { landmark(s)->mutable_covariance()->set_upper_triangle(5, 0); }},
      {"submap.landmark_sightings[0].covariance.upper_triangle:",
       [=](auto& s) { landmark(s)->mutable_covariance()->set_upper_triangle(2, 0.01); }},
      {"submap.landmark_sightings:", [=](auto& s) { fill(s.mutable_landmark_sightings(), 10001); }},
      {"submap.robot_sightings[0].index:", [=](auto& s) { robot(s)->set_index(-1); }},
      {"submap.robot_sightings[0].robot:", [=](auto& s) { robot(s)->set_robot("anna"); }},
      {"submap.robot_sightings[0].robot:", [=](auto& s) { robot(s)->set_robot("-"); }},
      {"submap.robot_sightings[0].point_in_body.x:",
       [=](auto& s) { robot(s)->mutable_point_in_body()->set_x(nan); }},
      {"submap.robot_sightings[0].covariance.upper_triangle:",
       [=](auto& s) { robot(s)->mutable_covariance()->add_upper_triangle(0); }},
      {"submap.robot_sightings:", [=](auto& s) { fill(s.mutable_robot_sightings(), 10001); }},
      {"submap.absolute_poses[0].index:", [=](auto& s) { pose(s)->set_index(15); }},
      {"submap.absolute_poses[0].map_tform_body.position:",
       [=](auto& s) { pose(s)->clear_map_tform_body(); }},
      {"submap.absolute_poses[0].covariance.upper_triangle:",
       [=](auto& s) { pose(s)->clear_covariance(); }},
      {"submap.absolute_poses:", [=](auto& s) { fill(s.mutable_absolute_poses(), 2001); }},
  };
}

TEST_F(UploadSubmapsTest, EveryBadSubmapIsRejectedByFieldAndChangesNothing) {
  Uploader uploader(*mapping_, "mine", kMission);
  uploader.Read();
  uploader.Send(MakeSubmap(0, 0, 10));
  Submap good = MakeSubmap(1, 10, 5);
  good.loop_closures.push_back(MakeClosure({kMission, 2}, {kMission, 12}));
  testing::AddOneOfEach(kMission, good);
  std::vector<BadSubmap> bads = BadSubmaps();
  for (BadSubmap& bad : BadBelongings()) bads.push_back(std::move(bad));
  for (const BadSubmap& bad : bads) {
    v1::Submap submap = ToProto(good);
    bad.spoil(submap);
    const auto answer = uploader.Send(submap);
    ASSERT_TRUE(answer.has_reject()) << bad.message << " " << answer.ShortDebugString();
    EXPECT_EQ(answer.reject().code(), static_cast<int>(absl::StatusCode::kInvalidArgument))
        << bad.message;
    EXPECT_THAT(answer.reject().message(), StartsWith(bad.message));
    EXPECT_EQ(UploadState("mine", kMission).next_sequence(), 1);
  }
  EXPECT_EQ(uploader.Send(good).ack().durable_through_sequence(), 1);
  EXPECT_EQ(WaitForNodes("mine", 15).NumNodes(), 15);
}

TEST_F(UploadSubmapsTest, ASubmapAboveOneMebibyteIsRejected) {
  Uploader uploader(*mapping_, "mine", kMission);
  uploader.Read();
  v1::Submap submap = ToProto(MakeSubmap(0, 0, 10));
  submap.mutable_loop_closures();
  v1::LoopClosure& closure = *submap.add_loop_closures();
  closure.mutable_from()->mutable_mission()->set_robot(std::string(1 << 20, 'a'));
  const auto answer = uploader.Send(submap);
  EXPECT_EQ(answer.reject().code(), static_cast<int>(absl::StatusCode::kInvalidArgument));
  EXPECT_THAT(answer.reject().message(), HasSubstr("1 MiB"));
  EXPECT_LE(answer.reject().message().size(), 1024u);
}

TEST_F(UploadSubmapsTest, AMessageAboveTheLimitEndsTheStreamAndNothingElse) {
  Uploader uploader(*mapping_, "mine", kMission);
  uploader.Read();
  v1::UploadSubmapsRequest request;
  request.mutable_header()->set_map(std::string(100 << 20, 'a'));
  uploader.Write(request);
  EXPECT_EQ(uploader.End().error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  Upload("mine", kMission, 1, 3);
}

TEST_F(UploadSubmapsTest, AStreamMustBeginWithOneHeader) {
  {
    grpc::ClientContext context;
    auto stream = mapping_->UploadSubmaps(&context);
    v1::UploadSubmapsRequest request;
    *request.mutable_submap() = ToProto(MakeSubmap(0, 0, 3));
    stream->Write(request);
    const grpc::Status status = stream->Finish();
    EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
    EXPECT_THAT(status.error_message(), StartsWith("header:"));
  }
  {
    Uploader uploader(*mapping_, "mine", kMission);
    uploader.Read();
    v1::UploadSubmapsRequest request;
    request.mutable_header()->set_map("mine");
    uploader.Write(request);
    EXPECT_EQ(uploader.End().error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  }
  {
    Uploader uploader(*mapping_, "mine", kMission);
    uploader.Read();
    uploader.Write(v1::UploadSubmapsRequest());
    EXPECT_THAT(uploader.End().error_message(), StartsWith("frame:"));
  }
  {
    Uploader uploader(*mapping_, "../etc", kMission);
    EXPECT_THAT(uploader.End().error_message(), StartsWith("header.map:"));
  }
  {
    Uploader uploader(*mapping_, "mine", MissionId{"anna", ""});
    EXPECT_THAT(uploader.End().error_message(), StartsWith("header.mission.mission:"));
  }
}

TEST_F(UploadSubmapsTest, TheNewerOfTwoStreamsOfAMissionWins) {
  Uploader older(*mapping_, "mine", kMission);
  older.Read();
  Uploader newer(*mapping_, "mine", kMission);
  EXPECT_TRUE(newer.Read().has_ready());
  EXPECT_EQ(older.End().error_code(), grpc::StatusCode::ABORTED);
  EXPECT_EQ(newer.Send(MakeSubmap(0, 0, 3)).ack().durable_through_sequence(), 0);
}

TEST_F(UploadSubmapsTest, ManySubmapsInFlightAreAllAcknowledged) {
  Uploader uploader(*mapping_, "mine", kMission);
  uploader.Read();
  for (int i = 0; i < 200; ++i) {
    v1::UploadSubmapsRequest request;
    *request.mutable_submap() = ToProto(MakeSubmap(i, 5 * i, 5));
    uploader.Write(request);
  }
  int64_t acknowledged = -1;
  while (acknowledged < 199) {
    const auto answer = uploader.Read();
    ASSERT_TRUE(answer.has_ack()) << answer.ShortDebugString();
    ASSERT_GT(answer.ack().durable_through_sequence(), acknowledged);
    acknowledged = answer.ack().durable_through_sequence();
  }
  EXPECT_TRUE(uploader.Close().ok());
}

TEST_F(UploadSubmapsTest, LimitsOfTheMapAreResourceExhausted) {
  ServerOptions options = testing::TestOptions();
  options.limits.max_maps = 1;
  options.limits.max_missions_per_map = 1;
  options.limits.max_keyframes_per_mission = 12;
  options.limits.max_loop_closures_per_map = 0;
  StartServer(options);
  const int exhausted = static_cast<int>(absl::StatusCode::kResourceExhausted);
  Uploader uploader(*mapping_, "mine", kMission);
  uploader.Read();
  ASSERT_TRUE(uploader.Send(MakeSubmap(0, 0, 10)).has_ack());
  EXPECT_EQ(uploader.Send(MakeSubmap(1, 10, 3)).reject().code(), exhausted);
  Submap closing = MakeSubmap(1, 10, 2);
  closing.loop_closures.push_back(MakeClosure({kMission, 2}, {kMission, 11}));
  EXPECT_EQ(uploader.Send(closing).reject().code(), exhausted);
  Uploader second_mission(*mapping_, "mine", MissionId{"bert", "run1"});
  second_mission.Read();
  EXPECT_EQ(second_mission.Send(MakeSubmap(0, 0, 1)).reject().code(), exhausted);
  Uploader second_map(*mapping_, "other", kMission);
  second_map.Read();
  EXPECT_EQ(second_map.Send(MakeSubmap(0, 0, 1)).reject().code(), exhausted);
}

}  // namespace
}  // namespace overtone
