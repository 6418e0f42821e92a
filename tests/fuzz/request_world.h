// SPDX-License-Identifier: Apache-2.0
// A server's state for requests to be about: the map "m" with missions of robots "anna" and "bert"
// and closures between them.
#ifndef OVERTONE_TESTS_FUZZ_REQUEST_WORLD_H_
#define OVERTONE_TESTS_FUZZ_REQUEST_WORLD_H_

#include <memory>
#include <vector>

#include "absl/synchronization/notification.h"
#include "overtone/core/mapping/multi_robot_map.h"
#include "overtone/proto/conversion/sha256.h"
#include "overtone/proto/conversion/submap_conversion.h"
#include "overtone/services/mapping_server/graph_frames.h"
#include "overtone/services/mapping_server/map_registry.h"
#include "overtone/services/mapping_server/submap_digest.h"
#include "overtone/services/mapping_server/upload_sessions.h"
#include "overtone/tests/fuzz/fuzz_input.h"
#include "overtone/tests/proto/conversion_fixture.h"

namespace overtone::fuzz {

inline ServerOptions WorldOptions() {
  ServerOptions options;
  options.data_dir = DataDirectory::kMemory;
  options.graph.min_distance_m = 0;  // every keyframe is a node
  options.graph.min_rotation_rad = 0;
  return options;
}

inline std::vector<MissionId> WorldMissions() { return {{"anna", "run"}, {"bert", "run"}}; }

inline std::vector<Submap> WorldSubmaps(const MissionId& mission) {
  Submap first = testing::MakeSubmap(0, 0, 6);
  if (mission.robot == "anna") testing::AddOneOfEach(mission, first);
  return {first, testing::MakeSubmap(1, 6, 4)};
}

inline std::vector<LoopClosure> WorldClosures() {
  const std::vector<MissionId> missions = WorldMissions();
  std::vector<LoopClosure> closures;
  for (int64_t i = 0; i < 4; ++i) {
    closures.push_back(testing::MakeClosure({missions[0], i}, {missions[1], i + 2}));
  }
  return closures;
}

class RequestWorld {
 public:
  RequestWorld()
      : options_(WorldOptions()),
        registry_(options_),
        decided_(options_.map),
        frames_("m", /*first_epoch=*/1, options_) {
    FillRegistry();
    FillDecided();
  }

  const ServerOptions& options() const { return options_; }
  const MapRegistry& registry() const { return registry_; }
  const UploadSessions& sessions() const { return sessions_; }
  // The same content, for operators' decisions: without a mapping thread to wait for.
  MultiRobotMap& decided() { return decided_; }
  // Stands at revision 2, and knows the way from revision 1.
  GraphFrames& frames() { return frames_; }

 private:
  void FillRegistry() {
    FUZZ_CHECK(registry_.Open().ok(), "no registry");
    const auto map = registry_.Acquire("m");
    FUZZ_CHECK(map.ok(), map.status().ToString());
    registry_.Keep(*map);
    for (const MissionId& mission : WorldMissions()) {
      for (const Submap& submap : WorldSubmaps(mission)) {
        std::string bytes = DeterministicBytes(ToProto(submap));
        std::string digest = Sha256(bytes);
        (*map)->store().Append(
            {mission, std::make_shared<const Submap>(submap), std::move(bytes), std::move(digest)},
            [](const absl::StatusOr<AppendResult>& result) {
              FUZZ_CHECK(result.ok(), result.status().ToString());
            });
      }
    }
    (*map)->store().Drain();
    // Decisions are taken between optimisations, in order: when the second one is taken, all of the
    // above is in a revision.
    for (int i = 0; i < 2; ++i) {
      absl::Notification taken;
      (*map)->Veto("none", [&taken](const absl::Status&) { taken.Notify(); });
      taken.WaitForNotification();
    }
    FUZZ_CHECK((*map)->published().snapshot->missions.size() == 2, "the map is not there");
  }

  void FillDecided() {
    for (const MissionId& mission : WorldMissions()) {
      for (const Submap& submap : WorldSubmaps(mission)) {
        FUZZ_CHECK(decided_.AddSubmap(mission, submap).ok(), "the map refuses a submap");
      }
    }
    frames_.SetSnapshot(decided_.Optimise());
    (void)frames_.Newest({options_.graph.max_nodes, false, ""}, v1::GRAPH_ENCODING_PLAIN);
    for (const LoopClosure& closure : WorldClosures()) {
      FUZZ_CHECK(decided_.AddLoopClosure(closure).ok(), "the map refuses a closure");
    }
    frames_.SetSnapshot(decided_.Optimise());
  }

  const ServerOptions options_;
  MapRegistry registry_;
  UploadSessions sessions_;
  MultiRobotMap decided_;
  GraphFrames frames_;
};

}  // namespace overtone::fuzz

#endif  // OVERTONE_TESTS_FUZZ_REQUEST_WORLD_H_
