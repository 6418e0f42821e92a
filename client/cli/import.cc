// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/import.h"

#include <filesystem>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "overtone/client/cli/replay_input.h"
#include "overtone/client/cli/robot_player.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/geometry_conversion.h"

namespace overtone {
namespace {

constexpr double kSameM = 1e-6;
constexpr double kSameRad = 1e-6;

// "MH_01 (easy)" becomes "mh_01__easy_".
std::string RobotIdOf(absl::string_view name) {
  std::string id = absl::AsciiStrToLower(name);
  for (char& c : id) {
    if (!absl::ascii_isalnum(c) && c != '_' && c != '-') c = '_';
  }
  return id;
}

absl::Status IsAnother(const std::string& map, const MissionId& mission, const std::string& how) {
  return absl::AlreadyExistsError(
      absl::StrCat("map ", map, " has a mission ", ToString(mission), " already, ", how,
                   ": --mission NAME imports beside it, `overtone delete --map ", map,
                   " --mission ", ToString(mission), "` makes room"));
}

bool SameKeyframe(const v1::Node& node, const Rigid3d& odometry, const Keyframe& keyframe) {
  return node.stamp_ns() == keyframe.stamp.ns &&
         (odometry.translation - keyframe.mission_from_body.translation).norm() < kSameM &&
         odometry.rotation.angularDistance(keyframe.mission_from_body.rotation) < kSameRad;
}

absl::Status CheckSamePoses(const v1::GetTrajectoryResponse& there, const std::string& map,
                            const RobotRecording& recording) {
  for (int i = 0; i < there.nodes_size() && i < there.odometry_size(); ++i) {
    ASSIGN_OR_RETURN(const Rigid3d odometry, FromProto(there.odometry(i)));
    if (!SameKeyframe(there.nodes(i), odometry, recording.keyframes[i])) {
      return IsAnother(map, recording.id, absl::StrCat("whose keyframe ", i, " is another"));
    }
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<ImportSource> ParseImportSource(absl::string_view text) {
  ImportSource source;
  const size_t colon = text.find(':');
  source.path = std::string(colon == absl::string_view::npos ? text : text.substr(colon + 1));
  source.robot = colon == absl::string_view::npos
                     ? RobotIdOf(std::filesystem::path(source.path).stem().string())
                     : std::string(text.substr(0, colon));
  source.g2o = absl::EndsWithIgnoreCase(source.path, ".g2o");
  if (!ValidateId(source.robot, "robot").ok()) {
    return absl::InvalidArgumentError(
        absl::StrCat("\"", text, "\": \"", source.robot,
                     "\" cannot be a robot's name ([a-z0-9][a-z0-9_-]{0,62}); say ROBOT:FILE"));
  }
  return source;
}

absl::StatusOr<RobotRecording> ReadImport(const ImportSource& source,
                                          const ImportOptions& options) {
  ReplayOptions replay;
  replay.dataset = source.g2o ? DatasetKind::kG2o : DatasetKind::kTum;
  replay.dataset_name = source.g2o ? "g2o" : "tum";
  replay.robots = {absl::StrCat(source.robot, ":", source.path)};
  replay.mission = options.mission;
  replay.keyframe_distance_m = options.keyframe_distance_m;
  replay.keyframe_rotation_rad = options.keyframe_rotation_rad;
  replay.odometry_sigma = options.odometry_sigma;
  ASSIGN_OR_RETURN(const ReplayInput input, MakeReplayInput(replay));
  std::vector<RobotRecording> recordings = MakeRecordings(input);
  return std::move(recordings.front());
}

absl::StatusOr<int64_t> KeyframesThere(AdminClient& admin, const std::string& map,
                                       const RobotRecording& recording) {
  const absl::StatusOr<std::vector<v1::Mission>> missions = admin.ListMissions(map);
  if (absl::IsNotFound(missions.status())) return 0;
  RETURN_IF_ERROR(missions.status());
  for (const v1::Mission& mission : *missions) {
    if (mission.id().robot() != recording.id.robot ||
        mission.id().mission() != recording.id.mission) {
      continue;
    }
    const int64_t count = mission.keyframes();
    if (count > static_cast<int64_t>(recording.keyframes.size())) {
      return IsAnother(map, recording.id, absl::StrCat("of ", count, " keyframes"));
    }
    if (count == 0) return 0;
    if (mission.first_stamp_ns() != recording.keyframes.front().stamp.ns ||
        mission.last_stamp_ns() != recording.keyframes[count - 1].stamp.ns) {
      return IsAnother(map, recording.id, "of another time");
    }
    const absl::StatusOr<v1::GetTrajectoryResponse> there =
        admin.GetTrajectory(map, recording.id, /*odometry=*/true);
    if (absl::IsResourceExhausted(there.status())) return count;  // too long: its times must do
    RETURN_IF_ERROR(there.status());
    if (there->nodes_size() > static_cast<int64_t>(recording.keyframes.size())) {
      return IsAnother(map, recording.id, "and it grows");
    }
    RETURN_IF_ERROR(CheckSamePoses(*there, map, recording));
    return count;
  }
  return 0;
}

absl::Status UploadRecording(const RobotRecording& recording, MappingClientOptions options,
                             absl::Duration timeout) {
  ASSIGN_OR_RETURN(const std::unique_ptr<RobotPlayer> player,
                   RobotPlayer::Create(recording, std::move(options), timeout));
  return player->Advance(std::numeric_limits<double>::infinity()).status();
}

}  // namespace overtone
