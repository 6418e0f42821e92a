// SPDX-License-Identifier: Apache-2.0
#include "overtone/proto/conversion/published_graph.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "overtone/proto/conversion/field_path.h"

namespace overtone {
namespace {

bool Within(const Rigid3d& a, const Rigid3d& b, const PublicationTolerance& tolerance) {
  return (a.translation - b.translation).norm() <= tolerance.position_m &&
         LogSO3(a.rotation.conjugate() * b.rotation).norm() <= tolerance.rotation_rad;
}

const MapMission* FindMission(const MapGraph& graph, const MissionId& id) {
  for (const MapMission& mission : graph.missions) {
    if (mission.id == id) return &mission;
  }
  return nullptr;
}

}  // namespace

absl::Status PublicationTolerance::Validate(const ColumnUnits& units) const {
  // A unit on each of three axes: where rotations are rounded towards zero the error is up to that.
  const double rounding = std::sqrt(3.0);
  if (!(position_m >= rounding * units.position_m)) {
    return InvalidField("position_tolerance_m",
                        absl::StrCat(position_m, " is below the rounding of the COMPACT encoding, ",
                                     rounding * units.position_m));
  }
  if (!(rotation_rad >= rounding * units.rotation_rad)) {
    return InvalidField(
        "rotation_tolerance_rad",
        absl::StrCat(rotation_rad, " is below the rounding of the COMPACT encoding, ",
                     rounding * units.rotation_rad));
  }
  return absl::OkStatus();
}

MapGraph PublishedGraph(const MapGraph& exact, const MapGraph& previous,
                        const PublicationTolerance& tolerance, const ColumnUnits& units) {
  MapGraph published = exact;
  for (MapMission& mission : published.missions) {
    const MapMission* old = FindMission(previous, mission.id);
    if (old != nullptr && Within(mission.map_from_mission, old->map_from_mission, tolerance)) {
      mission.map_from_mission = old->map_from_mission;
    }
    size_t next = 0;
    for (MapNode& node : mission.nodes) {
      const Rigid3d exact_pose = node.map_from_body;
      node = Quantised(node, units);
      if (old == nullptr) continue;
      while (next < old->nodes.size() && old->nodes[next].index < node.index) ++next;
      if (next == old->nodes.size() || old->nodes[next].index != node.index) continue;
      const Rigid3d& old_pose = old->nodes[next].map_from_body;
      if (Within(exact_pose, old_pose, tolerance)) node.map_from_body = old_pose;
    }
  }
  for (MapEdge& edge : published.edges) edge.weight = static_cast<float>(edge.weight);
  return published;
}

}  // namespace overtone
