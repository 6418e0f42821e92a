// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/map_file.h"

#include <algorithm>
#include <map>
#include <memory>
#include <sstream>

#include "Eigen/LU"
#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/graph/g2o_io.h"
#include "overtone/proto/conversion/field_path.h"
#include "overtone/proto/conversion/id_conversion.h"

namespace overtone {
namespace {

PoseGraphEdge OdometryEdge(const SnapshotMission& mission, size_t i, int vertex) {
  const Keyframe& keyframe = mission.keyframes[i];
  PoseGraphEdge edge;
  edge.from = vertex - 1;
  edge.to = vertex;
  edge.from_tform_to =
      mission.keyframes[i - 1].mission_from_body.Inverse() * keyframe.mission_from_body;
  edge.information = keyframe.motion_covariance.inverse();
  return edge;
}

PoseGraphEdge ClosureEdge(const LoopCandidate& closure,
                          const std::map<MissionId, int64_t>& first_vertex) {
  PoseGraphEdge edge;
  edge.from = static_cast<int>(first_vertex.at(closure.from.mission) + closure.from.index);
  edge.to = static_cast<int>(first_vertex.at(closure.to.mission) + closure.to.index);
  edge.from_tform_to = closure.from_tform_to;
  edge.information = closure.covariance.inverse();
  edge.kind = EdgeKind::kLoopClosure;
  return edge;
}

absl::StatusOr<SnapshotMissions> MissionsOf(const MapSnapshot& snapshot,
                                            const v1::ExportMapRequest& request) {
  SnapshotMissions missions;
  if (!request.has_mission()) {
    for (const SnapshotMission& mission : snapshot.missions) missions.push_back(&mission);
    return missions;
  }
  ASSIGN_OR_RETURN(const MissionId id, AtField("mission", FromProto(request.mission())));
  for (const SnapshotMission& mission : snapshot.missions) {
    if (mission.id == id) return SnapshotMissions{&mission};
  }
  return absl::NotFoundError(
      absl::StrCat("mission: no ", ToString(id), " in revision ", snapshot.revision));
}

}  // namespace

std::string TrajectoryFile(const SnapshotMissions& missions, TrajectoryFormat format) {
  std::ostringstream out;
  for (const SnapshotMission* mission : missions) {
    out << "# " << ToString(mission->id) << ", component " << mission->component << ", "
        << (mission->anchored ? "anchored" : "unanchored") << "\n";
    Trajectory trajectory;
    for (size_t i = 0; i < mission->map_from_body.size(); ++i) {
      trajectory.push_back({mission->keyframes[i].stamp, mission->map_from_body[i]});
    }
    WriteTrajectory(out, format, trajectory);
  }
  return out.str();
}

std::string G2oFileOf(const MapSnapshot& snapshot, const SnapshotMissions& missions) {
  PoseGraph graph;
  std::map<MissionId, int64_t> first_vertex;
  for (const SnapshotMission* mission : missions) {
    first_vertex[mission->id] = static_cast<int64_t>(graph.poses.size());
    for (size_t i = 0; i < mission->map_from_body.size(); ++i) {
      const int vertex = static_cast<int>(graph.poses.size());
      graph.poses.push_back(mission->map_from_body[i]);
      if (i > 0) graph.edges.push_back(OdometryEdge(*mission, i, vertex));
    }
  }
  for (const ClosureRecord& record : snapshot.closures) {
    const LoopCandidate& closure = record.candidate;
    if (!InUse(record.verdict) || first_vertex.count(closure.from.mission) == 0 ||
        first_vertex.count(closure.to.mission) == 0) {
      continue;
    }
    graph.edges.push_back(ClosureEdge(closure, first_vertex));
  }
  std::ostringstream out;
  WriteG2o(out, graph);
  return out.str();
}

absl::StatusOr<std::string> MapFile(const MapRegistry& registry,
                                    const v1::ExportMapRequest& request) {
  ASSIGN_OR_RETURN(const std::shared_ptr<HostedMap> map, registry.Find(request.map()));
  const std::shared_ptr<const MapSnapshot> snapshot = map->published().snapshot;
  ASSIGN_OR_RETURN(const SnapshotMissions missions, MissionsOf(*snapshot, request));
  switch (request.format()) {
    case v1::EXPORT_FORMAT_TUM:
      return TrajectoryFile(missions, TrajectoryFormat::kTum);
    case v1::EXPORT_FORMAT_KITTI:
      return TrajectoryFile(missions, TrajectoryFormat::kKitti);
    case v1::EXPORT_FORMAT_EUROC:
      return TrajectoryFile(missions, TrajectoryFormat::kEuroc);
    case v1::EXPORT_FORMAT_G2O:
      return G2oFileOf(*snapshot, missions);
    default:
      return InvalidField("format",
                          absl::StrCat(request.format(), " is not one of ExportFormat's"));
  }
}

}  // namespace overtone
