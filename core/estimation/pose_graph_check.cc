// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/estimation/pose_graph_check.h"

#include <cmath>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/estimation/square_root_information.h"

namespace overtone {
namespace {

constexpr double kUnitLengthTolerance = 1e-6;
// Far beyond any real graph, yet their squares and products stay finite.
constexpr double kLargestTranslationM = 1e15;
constexpr double kLargestInformation = 1e30;

template <typename... Where>
absl::Status Prefix(const absl::Status& status, const Where&... where) {
  if (status.ok()) return status;
  return absl::Status(status.code(), absl::StrCat(where..., ": ", status.message()));
}

absl::Status CheckPoint(const Eigen::Vector3d& point) {
  if (!point.allFinite()) return absl::InvalidArgumentError("not finite");
  if (point.cwiseAbs().maxCoeff() > kLargestTranslationM) {
    return absl::InvalidArgumentError("translation exceeds 1e15 m");
  }
  return absl::OkStatus();
}

absl::Status CheckPose(const Rigid3d& pose) {
  if (!pose.rotation.coeffs().allFinite()) return absl::InvalidArgumentError("not finite");
  RETURN_IF_ERROR(CheckPoint(pose.translation));
  if (std::abs(pose.rotation.norm() - 1) > kUnitLengthTolerance) {
    return absl::InvalidArgumentError("quaternion is not of unit length");
  }
  return absl::OkStatus();
}

absl::Status CheckIndex(const char* name, int index, size_t size) {
  if (index >= 0 && index < static_cast<int>(size)) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(name, " = ", index, " is out of range"));
}

template <typename Matrix>
absl::Status CheckSize(const Matrix& information) {
  if (information.cwiseAbs().maxCoeff() > kLargestInformation) {
    return absl::InvalidArgumentError("information exceeds 1e30");
  }
  return absl::OkStatus();
}

absl::Status CheckEdge(const PoseGraphEdge& edge, const PoseGraph& graph) {
  RETURN_IF_ERROR(CheckIndex("from", edge.from, graph.poses.size()));
  RETURN_IF_ERROR(CheckIndex("to", edge.to, graph.poses.size()));
  if (edge.from == edge.to) return absl::InvalidArgumentError("both ends are the same pose");
  RETURN_IF_ERROR(CheckSize(edge.information));
  return Prefix(CheckPose(edge.from_tform_to), "from_tform_to");
}

absl::Status CheckSighting(const PointSighting& sighting, const PoseGraph& graph) {
  RETURN_IF_ERROR(CheckIndex("pose", sighting.pose, graph.poses.size()));
  if (sighting.landmark != -1) {
    RETURN_IF_ERROR(CheckIndex("landmark", sighting.landmark, graph.landmarks.size()));
    if (sighting.target_pose != -1) {
      return absl::InvalidArgumentError("both a landmark and a target pose");
    }
  } else {
    RETURN_IF_ERROR(CheckIndex("target_pose", sighting.target_pose, graph.poses.size()));
    if (sighting.pose == sighting.target_pose) {
      return absl::InvalidArgumentError("both ends are the same pose");
    }
  }
  RETURN_IF_ERROR(CheckSize(sighting.information));
  RETURN_IF_ERROR(Prefix(CheckPoint(sighting.point_in_target), "point_in_target"));
  return Prefix(CheckPoint(sighting.point_in_pose), "point_in_pose");
}

// The checks of an element and its factor, or which element is at fault and why.
template <typename Element, typename Check, typename Factor>
absl::Status CheckAll(const std::vector<Element>& elements, const char* name, const Check& check,
                      const PoseGraph& graph, std::vector<Factor>& factors) {
  factors.reserve(elements.size());
  for (size_t k = 0; k < elements.size(); ++k) {
    RETURN_IF_ERROR(Prefix(check(elements[k], graph), name, "[", k, "]"));
    const auto factor = SquareRootInformation(elements[k].information);
    RETURN_IF_ERROR(Prefix(factor.status(), name, "[", k, "]"));
    factors.push_back(*factor);
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<PoseGraphFactors> CheckAndFactorise(const PoseGraph& graph) {
  for (size_t i = 0; i < graph.poses.size(); ++i) {
    RETURN_IF_ERROR(Prefix(CheckPose(graph.poses[i]), "poses[", i, "]"));
  }
  for (size_t i = 0; i < graph.landmarks.size(); ++i) {
    RETURN_IF_ERROR(Prefix(CheckPoint(graph.landmarks[i]), "landmarks[", i, "]"));
  }
  PoseGraphFactors factors;
  RETURN_IF_ERROR(CheckAll(graph.edges, "edges", CheckEdge, graph, factors.edges));
  RETURN_IF_ERROR(CheckAll(graph.sightings, "sightings", CheckSighting, graph, factors.sightings));
  return factors;
}

absl::Status CheckPoseGraph(const PoseGraph& graph) { return CheckAndFactorise(graph).status(); }

}  // namespace overtone
