// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/synchronization/node_association.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <map>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "overtone/core/geometry/trajectory.h"

namespace overtone {
namespace {

constexpr double kUnitLengthTolerance = 1e-3;

bool IndexLess(const NodePose& a, const NodePose& b) { return a.index < b.index; }

absl::Status BadKeyframe(int64_t index, absl::string_view what) {
  return absl::InvalidArgumentError(absl::StrCat("trajectory: keyframe ", index, ": ", what));
}

std::vector<NodeMatch> AssociateByIndex(const std::vector<MapNode>& nodes,
                                        const std::vector<NodePose>& onboard) {
  std::vector<NodeMatch> matches;
  int next = 0;
  for (int server = 0; server < nodes.size(); ++server) {
    while (next < onboard.size() && onboard[next].index < nodes[server].index) ++next;
    if (next < onboard.size() && onboard[next].index == nodes[server].index) {
      matches.push_back({server, next++});
    }
  }
  return matches;
}

std::vector<NodeMatch> AssociateByStamp(const std::vector<MapNode>& nodes,
                                        const std::vector<NodePose>& onboard, double tolerance_s) {
  std::vector<Timestamp> server_stamps, onboard_stamps;
  for (const MapNode& node : nodes) server_stamps.push_back(node.stamp);
  for (const NodePose& node : onboard) onboard_stamps.push_back(node.stamp);
  std::vector<std::pair<int, int>> pairs =
      AssociateByTime(server_stamps, onboard_stamps, tolerance_s);
  const auto distance_ns = [&](const std::pair<int, int>& pair) {
    return std::abs(server_stamps[pair.first].ns - onboard_stamps[pair.second].ns);
  };
  std::stable_sort(pairs.begin(), pairs.end(),
                   [&](const auto& a, const auto& b) { return distance_ns(a) < distance_ns(b); });
  // Server position -> onboard position, both increasing.
  std::map<int, int> kept;
  for (const auto& [server, own] : pairs) {
    const auto after = kept.lower_bound(server);
    const bool early_enough = after == kept.end() || own < after->second;
    const bool late_enough = after == kept.begin() || own > std::prev(after)->second;
    if (early_enough && late_enough) kept.emplace(server, own);
  }
  std::vector<NodeMatch> matches;
  for (const auto& [server, own] : kept) matches.push_back({server, own});
  return matches;
}

}  // namespace

absl::StatusOr<std::vector<NodePose>> CheckedTrajectory(std::vector<NodePose> trajectory) {
  if (!std::is_sorted(trajectory.begin(), trajectory.end(), IndexLess)) {
    std::sort(trajectory.begin(), trajectory.end(), IndexLess);
  }
  for (int i = 0; i < trajectory.size(); ++i) {
    NodePose& node = trajectory[i];
    Eigen::Quaterniond& rotation = node.estimate_from_body.rotation;
    if (node.index < 0) return BadKeyframe(node.index, "negative index");
    if (i > 0 && trajectory[i - 1].index == node.index) {
      return BadKeyframe(node.index, "given twice");
    }
    if (!node.estimate_from_body.translation.allFinite() || !rotation.coeffs().allFinite()) {
      return BadKeyframe(node.index, "pose is not finite");
    }
    if (!(std::abs(rotation.norm() - 1) <= kUnitLengthTolerance)) {
      return BadKeyframe(node.index, "quaternion is not of unit length");
    }
    rotation.normalize();
  }
  return trajectory;
}

std::vector<NodeMatch> AssociateNodes(const MapMission& mission,
                                      const std::vector<NodePose>& onboard, double tolerance_s) {
  const bool indices_known = std::all_of(mission.nodes.begin(), mission.nodes.end(),
                                         [](const MapNode& node) { return node.index >= 0; });
  return indices_known ? AssociateByIndex(mission.nodes, onboard)
                       : AssociateByStamp(mission.nodes, onboard, tolerance_s);
}

}  // namespace overtone
