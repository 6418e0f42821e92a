// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/checkpoint_codec.h"

#include <utility>

#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/geometry_conversion.h"
#include "overtone/proto/conversion/id_conversion.h"
#include "overtone/services/mapping_server/closure_messages.h"
#include "overtone/services/mapping_server/map_log.h"
#include "overtone/storage/v1/map_log.pb.h"

namespace overtone {
namespace {

constexpr int kNumbersPerPose = 7;

void AddPose(const Rigid3d& pose, storage::v1::CheckpointMission& message) {
  for (int i = 0; i < 3; ++i) message.add_poses(pose.translation(i));
  for (int i = 0; i < 4; ++i) message.add_poses(pose.rotation.coeffs()(i));  // x y z w
}

storage::v1::CheckpointMission ToStorage(const MapCheckpoint::Mission& mission) {
  storage::v1::CheckpointMission message;
  *message.mutable_id() = ToProto(mission.id);
  message.set_frame(mission.frame);
  message.mutable_poses()->Reserve(
      static_cast<int>(mission.frame_from_body.size() * kNumbersPerPose));
  for (const Rigid3d& pose : mission.frame_from_body) AddPose(pose, message);
  return message;
}

absl::StatusOr<MapCheckpoint::Mission> FromStorage(const storage::v1::CheckpointMission& message) {
  MapCheckpoint::Mission mission;
  ASSIGN_OR_RETURN(mission.id, FromProto(message.id()));
  mission.frame = message.frame();
  if (message.poses_size() % kNumbersPerPose != 0) return absl::DataLossError("poses: incomplete");
  const double* numbers = message.poses().data();
  for (int k = 0; k < message.poses_size(); k += kNumbersPerPose, numbers += kNumbersPerPose) {
    mission.frame_from_body.emplace_back(
        Eigen::Quaterniond(Eigen::Map<const Eigen::Vector4d>(numbers + 3)),
        Eigen::Map<const Eigen::Vector3d>(numbers));
  }
  return mission;
}

storage::v1::CheckpointClosure ToStorage(const MapCheckpoint::Closure& closure) {
  storage::v1::CheckpointClosure message;
  message.set_id(closure.id);
  message.set_verdict(ToProto(closure.verdict));
  message.set_weight(closure.weight);
  message.set_chi_square(closure.chi_square);
  message.set_since_revision(closure.since_revision);
  message.set_consistent_set(closure.consistent_set);
  return message;
}

MapCheckpoint::Closure FromStorage(const storage::v1::CheckpointClosure& message) {
  return {message.id(),         FromProto(message.verdict()), message.weight(),
          message.chi_square(), message.since_revision(),     message.consistent_set()};
}

}  // namespace

std::string ToBytes(const StoredCheckpoint& checkpoint) {
  const MapCheckpoint& map = checkpoint.map;
  storage::v1::Checkpoint message;
  message.set_map_epoch(map.decisions.map_epoch);
  message.set_revision(map.revision);
  message.set_entries(checkpoint.entries);
  message.set_reserved_through_revision(checkpoint.reserved_through_revision);
  for (const MapCheckpoint::Mission& mission : map.missions) {
    *message.add_missions() = ToStorage(mission);
  }
  for (const MapCheckpoint::Closure& closure : map.closures) {
    *message.add_closures() = ToStorage(closure);
  }
  message.mutable_sighting_weights()->Add(map.sighting_weights.begin(), map.sighting_weights.end());
  message.mutable_absolute_weights()->Add(map.absolute_weights.begin(), map.absolute_weights.end());
  for (const MapCheckpoint::Landmark& landmark : map.landmarks) {
    storage::v1::CheckpointLandmark& out = *message.add_landmarks();
    out.set_frame(landmark.frame);
    out.set_id(landmark.id);
    *out.mutable_position() = ToProto(landmark.position);
  }
  ToStorage(map.decisions, message.mutable_decisions());
  for (const RevisionRecord& record : map.revisions) *message.add_revisions() = ToProto(record);
  message.set_initial_cost(map.initial_cost);
  message.set_final_cost(map.final_cost);
  message.set_converged(map.converged);
  message.set_optimisation_s(map.optimisation_s);
  return message.SerializeAsString();
}

absl::StatusOr<StoredCheckpoint> ParseCheckpoint(const std::string& bytes) {
  storage::v1::Checkpoint message;
  if (!message.ParseFromString(bytes)) return absl::DataLossError("not a checkpoint");
  StoredCheckpoint checkpoint;
  MapCheckpoint& map = checkpoint.map;
  map.revision = message.revision();
  checkpoint.entries = message.entries();
  checkpoint.reserved_through_revision = message.reserved_through_revision();
  for (const storage::v1::CheckpointMission& mission : message.missions()) {
    ASSIGN_OR_RETURN(MapCheckpoint::Mission read, FromStorage(mission));
    map.missions.push_back(std::move(read));
  }
  for (const storage::v1::CheckpointClosure& closure : message.closures()) {
    map.closures.push_back(FromStorage(closure));
  }
  map.sighting_weights.assign(message.sighting_weights().begin(), message.sighting_weights().end());
  map.absolute_weights.assign(message.absolute_weights().begin(), message.absolute_weights().end());
  for (const storage::v1::CheckpointLandmark& landmark : message.landmarks()) {
    const v1::Vector3& position = landmark.position();
    map.landmarks.push_back(
        {landmark.frame(), landmark.id(), {position.x(), position.y(), position.z()}});
  }
  map.decisions = {message.map_epoch(), FromStorage(message.decisions())};
  for (const v1::Revision& revision : message.revisions()) {
    map.revisions.push_back(FromProto(revision));
  }
  map.initial_cost = message.initial_cost();
  map.final_cost = message.final_cost();
  map.converged = message.converged();
  map.optimisation_s = message.optimisation_s();
  return checkpoint;
}

}  // namespace overtone
