// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/map_file.h"

#include <algorithm>
#include <map>
#include <sstream>

#include "Eigen/LU"
#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/geometry/trajectory_io.h"
#include "overtone/core/graph/g2o_io.h"
#include "overtone/proto/conversion/field_path.h"

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

}  // namespace

std::string TumFile(const MapSnapshot& snapshot) {
  std::ostringstream out;
  for (const SnapshotMission& mission : snapshot.missions) {
    out << "# " << ToString(mission.id) << ", component " << mission.component << ", "
        << (mission.anchored ? "anchored" : "unanchored") << "\n";
    Trajectory trajectory;
    for (size_t i = 0; i < mission.map_from_body.size(); ++i) {
      trajectory.push_back({mission.keyframes[i].stamp, mission.map_from_body[i]});
    }
    WriteTrajectory(out, TrajectoryFormat::kTum, trajectory);
  }
  return out.str();
}

std::string G2oFileOf(const MapSnapshot& snapshot) {
  PoseGraph graph;
  std::map<MissionId, int64_t> first_vertex;
  for (const SnapshotMission& mission : snapshot.missions) {
    first_vertex[mission.id] = static_cast<int64_t>(graph.poses.size());
    for (size_t i = 0; i < mission.map_from_body.size(); ++i) {
      const int vertex = static_cast<int>(graph.poses.size());
      graph.poses.push_back(mission.map_from_body[i]);
      if (i > 0) graph.edges.push_back(OdometryEdge(mission, i, vertex));
    }
  }
  for (const ClosureRecord& record : snapshot.closures) {
    if (!InUse(record.verdict)) continue;
    graph.edges.push_back(ClosureEdge(record.candidate, first_vertex));
  }
  std::ostringstream out;
  WriteG2o(out, graph);
  return out.str();
}

absl::StatusOr<std::string> MapFile(const MapRegistry& registry,
                                    const v1::ExportMapRequest& request) {
  ASSIGN_OR_RETURN(const std::shared_ptr<HostedMap> map, registry.Find(request.map()));
  const std::shared_ptr<const MapSnapshot> snapshot = map->published().snapshot;
  switch (request.format()) {
    case v1::EXPORT_FORMAT_TUM:
      return TumFile(*snapshot);
    case v1::EXPORT_FORMAT_G2O:
      return G2oFileOf(*snapshot);
    default:
      return InvalidField("format", absl::StrCat(request.format(), " is neither TUM nor G2O"));
  }
}

}  // namespace overtone
