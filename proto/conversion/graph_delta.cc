// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <iterator>
#include <utility>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/field_path.h"
#include "overtone/proto/conversion/graph_conversion.h"
#include "overtone/proto/conversion/graph_messages.h"
#include "overtone/proto/conversion/id_conversion.h"
#include "overtone/proto/conversion/limits.h"

namespace overtone {
namespace {

bool Same(const Rigid3d& a, const Rigid3d& b) {
  return a.translation == b.translation && a.rotation.coeffs() == b.rotation.coeffs();
}

bool Same(const MapNode& a, const MapNode& b) {
  return a.index == b.index && a.stamp == b.stamp && a.submap_start == b.submap_start &&
         a.degenerate == b.degenerate && Same(a.map_from_body, b.map_from_body);
}

bool SameHeader(const MapMission& a, const MapMission& b) {
  return a.anchored == b.anchored && a.component == b.component &&
         Same(a.map_from_mission, b.map_from_mission);
}

const MapMission* FindMission(const MapGraph& graph, const MissionId& id) {
  const auto it = std::lower_bound(
      graph.missions.begin(), graph.missions.end(), id,
      [](const MapMission& mission, const MissionId& wanted) { return mission.id < wanted; });
  return it != graph.missions.end() && it->id == id ? &*it : nullptr;
}

bool ByIndex(const MapNode& a, const MapNode& b) { return a.index < b.index; }

// Nodes of `target` that `base` lacks or has otherwise.
std::vector<MapNode> ChangedNodes(const std::vector<MapNode>& base,
                                  const std::vector<MapNode>& target) {
  std::vector<MapNode> changed;
  auto old = base.begin();
  for (const MapNode& node : target) {
    while (old != base.end() && old->index < node.index) ++old;
    if (old == base.end() || !Same(*old, node)) changed.push_back(node);
  }
  return changed;
}

std::vector<int64_t> RemovedIndices(const std::vector<MapNode>& base,
                                    const std::vector<MapNode>& target) {
  std::vector<int64_t> removed;
  for (const MapNode& node : base) {
    if (!std::binary_search(target.begin(), target.end(), node, ByIndex)) {
      removed.push_back(node.index);
    }
  }
  return removed;
}

// What `target` has instead of `base`. False: nothing.
bool MissionChanges(const MapMission& base, const MapMission& target, const GraphFormat& format,
                    v1::MissionNodes& message) {
  const std::vector<MapNode> changed = ChangedNodes(base.nodes, target.nodes);
  const std::vector<int64_t> removed = RemovedIndices(base.nodes, target.nodes);
  if (changed.empty() && removed.empty() && SameHeader(base, target)) return false;
  message = ToProto(target, changed, format);
  message.mutable_removed()->Add(removed.begin(), removed.end());
  return true;
}

absl::Status RemoveNodes(const std::vector<int64_t>& removed, std::vector<MapNode>& nodes) {
  size_t next = 0;
  const auto is_removed = [&](const MapNode& node) {
    if (next == removed.size() || node.index != removed[next]) return false;
    ++next;
    return true;
  };
  nodes.erase(std::remove_if(nodes.begin(), nodes.end(), is_removed), nodes.end());
  if (next == removed.size()) return absl::OkStatus();
  return InvalidField("removed", absl::StrCat("node ", removed[next], " is not in the base"));
}

// The union by index; of two nodes with one index the changed one.
std::vector<MapNode> MergeNodes(const std::vector<MapNode>& changed,
                                const std::vector<MapNode>& base) {
  std::vector<MapNode> merged;
  merged.reserve(changed.size() + base.size());
  std::set_union(changed.begin(), changed.end(), base.begin(), base.end(),
                 std::back_inserter(merged), ByIndex);
  return merged;
}

absl::StatusOr<MapMission> ApplyToMission(const MapMission* base, DecodedMission changes) {
  MapMission mission = std::move(changes.mission);
  std::vector<MapNode> kept;
  if (base != nullptr) kept = base->nodes;
  RETURN_IF_ERROR(RemoveNodes(changes.removed, kept));
  mission.nodes = MergeNodes(mission.nodes, kept);
  return mission;
}

absl::StatusOr<std::vector<MissionId>> RemovedMissions(const MapGraph& base,
                                                       const v1::GraphDelta& delta) {
  std::vector<MissionId> removed;
  for (int i = 0; i < delta.removed_missions_size(); ++i) {
    ASSIGN_OR_RETURN(MissionId id,
                     AtField("removed_missions", i, FromProto(delta.removed_missions(i))));
    if (FindMission(base, id) == nullptr) {
      return InvalidField(absl::StrCat("removed_missions[", i, "]"),
                          absl::StrCat(ToString(id), " is not in the base"));
    }
    removed.push_back(std::move(id));
  }
  std::sort(removed.begin(), removed.end());
  return removed;
}

absl::Status ValidateBase(const MapGraph& base, const v1::GraphDelta& delta) {
  const v1::Graph& changes = delta.changes();
  if (delta.base_revision() != base.revision || changes.map_epoch() != base.map_epoch) {
    return absl::FailedPreconditionError(absl::StrCat(
        "base_revision: the delta applies to revision ", delta.base_revision(), " of epoch ",
        changes.map_epoch(), ", here is ", base.revision, " of ", base.map_epoch));
  }
  if (changes.revision() > base.revision) return absl::OkStatus();
  return InvalidField("changes.revision", "not after base_revision");
}

}  // namespace

v1::GraphDelta MakeDelta(const MapGraph& base, const MapGraph& target, const GraphFormat& format) {
  v1::GraphDelta delta;
  delta.set_base_revision(base.revision);
  *delta.mutable_changes() = GraphHeader(target, format);
  for (const MapMission& mission : target.missions) {
    const MapMission* old = FindMission(base, mission.id);
    v1::MissionNodes changes;
    if (old == nullptr) {
      changes = ToProto(mission, mission.nodes, format);
    } else if (!MissionChanges(*old, mission, format, changes)) {
      continue;
    }
    *delta.mutable_changes()->add_missions() = std::move(changes);
  }
  for (const MapMission& mission : base.missions) {
    if (FindMission(target, mission.id) == nullptr) {
      *delta.add_removed_missions() = ToProto(mission.id);
    }
  }
  return delta;
}

absl::StatusOr<MapGraph> ApplyDelta(const MapGraph& base, const v1::GraphDelta& delta) {
  RETURN_IF_ERROR(ValidateBase(base, delta));
  ASSIGN_OR_RETURN(std::vector<DecodedMission> changes,
                   AtField("changes", DecodeMissions(delta.changes())));
  ASSIGN_OR_RETURN(const std::vector<MissionId> removed, RemovedMissions(base, delta));

  MapGraph graph;
  graph.revision = delta.changes().revision();
  graph.map_epoch = delta.changes().map_epoch();
  for (size_t i = 0; i < changes.size(); ++i) {
    const MapMission* old = FindMission(base, changes[i].mission.id);
    ASSIGN_OR_RETURN(MapMission mission, AtField("changes.missions", static_cast<int>(i),
                                                 ApplyToMission(old, std::move(changes[i]))));
    graph.missions.push_back(std::move(mission));
  }
  const size_t num_changed = graph.missions.size();
  for (const MapMission& mission : base.missions) {
    const auto end_of_changed = graph.missions.begin() + num_changed;
    const bool changed = std::any_of(graph.missions.begin(), end_of_changed,
                                     [&](const MapMission& m) { return m.id == mission.id; });
    const bool gone = std::binary_search(removed.begin(), removed.end(), mission.id);
    if (!changed && !gone) graph.missions.push_back(mission);
  }
  std::sort(graph.missions.begin(), graph.missions.end(),
            [](const MapMission& a, const MapMission& b) { return a.id < b.id; });
  if (graph.NumNodes() > limits::kMaxGraphNodes) {
    return InvalidField("changes.missions", "more than 1,000,000 nodes with those of the base");
  }
  ASSIGN_OR_RETURN(graph.edges,
                   AtField("changes", DecodeEdges(delta.changes().edges(), graph.NumNodes())));
  return graph;
}

}  // namespace overtone
