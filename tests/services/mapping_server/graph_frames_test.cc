// SPDX-License-Identifier: Apache-2.0
// What is kept for deltas, and what is forgotten.
#include "overtone/services/mapping_server/graph_frames.h"

#include <memory>
#include <string>

#include "grpcpp/impl/codegen/proto_utils.h"
#include "gtest/gtest.h"
#include "overtone/tests/proto/conversion_fixture.h"
#include "overtone/v1/mapping_service.pb.h"

namespace overtone {
namespace {

using testing::MakeSubmap;

constexpr uint64_t kEpoch = 4;
constexpr int kKeyframes = 10;

std::string RobotName(int number) { return "robot" + std::to_string(number); }

// So many robots, each with one mission of ten keyframes.
std::shared_ptr<const MapSnapshot> Snapshot(int robots, uint64_t revision) {
  auto snapshot = std::make_shared<MapSnapshot>();
  snapshot->revision = revision;
  snapshot->map_epoch = kEpoch;
  for (int i = 0; i < robots; ++i) {
    SnapshotMission mission;
    mission.id = {RobotName(i), "run1"};
    mission.anchored = true;
    mission.keyframes = MakeSubmap(0, 0, kKeyframes).keyframes;
    for (const Keyframe& keyframe : mission.keyframes) {
      mission.map_from_body.push_back(keyframe.mission_from_body);
    }
    mission.submap_starts = {0};
    snapshot->missions.push_back(mission);
  }
  return snapshot;
}

// Room for three graphs of ten nodes, or what the map's size allows.
ServerOptions Options() {
  ServerOptions options;
  options.publisher.max_variants = 3;
  options.publisher.history = 2;
  options.graph.max_nodes = kKeyframes;
  options.graph.min_distance_m = 0;
  options.graph.min_rotation_rad = 0;
  return options;
}

// Whether a reader that has `revision` gets a delta.
bool GetsDelta(GraphFrames& frames, const GraphQuery& query, uint64_t revision) {
  absl::StatusOr<grpc::ByteBuffer> frame =
      frames.Frame(query, v1::GRAPH_ENCODING_COMPACT, {kEpoch, revision});
  EXPECT_TRUE(frame.ok()) << frame.status();
  v1::WatchGraphResponse response;
  EXPECT_TRUE(
      grpc::SerializationTraits<v1::WatchGraphResponse>::Deserialize(&*frame, &response).ok());
  return response.has_delta();
}

TEST(GraphFrames, EveryRobotThatAsksForItsOwnNodesGetsDeltas) {
  constexpr int kRobots = 40;
  GraphFrames frames("mine", kEpoch, Options());
  for (uint64_t revision = 1; revision <= 3; ++revision) {
    frames.SetSnapshot(Snapshot(kRobots, revision));
    for (int i = 0; i < kRobots; ++i) {
      EXPECT_EQ(GetsDelta(frames, {kKeyframes, false, RobotName(i)}, revision - 1), revision > 1)
          << "robot " << i << ", revision " << revision;
    }
  }
}

TEST(GraphFrames, WhatWasNotAskedForForLongestIsForgottenFirst) {
  GraphFrames frames("mine", kEpoch, Options());
  frames.SetSnapshot(Snapshot(1, 1));
  constexpr int kFirst = 100, kLast = 109;  // node limits that change nothing
  for (int limit = kFirst; limit <= kLast; ++limit) GetsDelta(frames, {limit, false, ""}, 0);
  frames.SetSnapshot(Snapshot(1, 2));
  EXPECT_TRUE(GetsDelta(frames, {kLast, false, ""}, 1));
  EXPECT_FALSE(GetsDelta(frames, {kFirst, false, ""}, 1));
}

TEST(GraphFrames, NoMoreAreKeptThanCanBeWatched) {
  ServerOptions options = Options();
  options.limits.max_watchers_per_map = 5;
  GraphFrames frames("mine", kEpoch, options);
  frames.SetSnapshot(Snapshot(1, 1));
  // Robots that the map does not have: graphs without nodes, which weigh nothing.
  for (int i = 10; i < 20; ++i) GetsDelta(frames, {kKeyframes, false, RobotName(i)}, 0);
  frames.SetSnapshot(Snapshot(1, 2));
  EXPECT_TRUE(GetsDelta(frames, {kKeyframes, false, RobotName(19)}, 1));
  EXPECT_FALSE(GetsDelta(frames, {kKeyframes, false, RobotName(10)}, 1));
}

}  // namespace
}  // namespace overtone
