// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/g2o_recording.h"

#include <cmath>
#include <fstream>
#include <map>
#include <utility>

#include "Eigen/LU"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "overtone/core/common/line_reader.h"
#include "overtone/core/common/parse_number.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/geometry/parse_pose.h"
#include "overtone/core/geometry/trajectory_io.h"
#include "overtone/core/graph/g2o_io.h"

namespace overtone {
namespace {

constexpr double kOutOfPlaneTranslation_m = 1;
constexpr double kOutOfPlaneRotation_rad = 0.1;

// Axes of the ground plane's graph (x ahead, y left, z up) in those of the camera (x right, y down,
// z ahead).
Rigid3d CameraFromGraph() {
  Eigen::Matrix3d axes;
  axes << 0, -1, 0,  //
      0, 0, -1,      //
      1, 0, 0;
  return Rigid3d(Eigen::Quaterniond(axes), Eigen::Vector3d::Zero());
}

FrameClosure ToFrameClosure(const G2oFile& file, const PoseGraphEdge& edge) {
  return {file.vertex_ids[edge.from], file.vertex_ids[edge.to], edge.from_tform_to,
          edge.information.inverse()};
}

// The same motion, seen in other axes of the two bodies.
FrameClosure InOtherAxes(const Rigid3d& new_from_old, FrameClosure closure) {
  const Matrix6d adjoint = Adjoint(new_from_old);
  closure.from_tform_to = new_from_old * closure.from_tform_to * new_from_old.Inverse();
  closure.covariance = adjoint * closure.covariance * adjoint.transpose();
  return closure;
}

}  // namespace

absl::StatusOr<Recording> ReadG2oRecording(const std::string& path) {
  ASSIGN_OR_RETURN(const G2oFile file, ReadG2o(path));
  Recording recording;
  std::map<int, FrameClosure> motions;  // into each vertex, forward
  for (const PoseGraphEdge& edge : file.graph.edges) {
    FrameClosure motion = ToFrameClosure(file, edge);
    if (edge.kind == EdgeKind::kLoopClosure) {
      recording.closures.push_back(motion);
    } else if (edge.from > edge.to) {
      const Matrix6d adjoint = Adjoint(motion.from_tform_to);
      motions.try_emplace(
          edge.from,
          FrameClosure{motion.to_frame, motion.from_frame, motion.from_tform_to.Inverse(),
                       adjoint * motion.covariance * adjoint.transpose()});
    } else {
      motions.try_emplace(edge.to, motion);
    }
  }
  Rigid3d mission_from_body;
  for (int i = 0; i < static_cast<int>(file.vertex_ids.size()); ++i) {
    const auto motion = motions.find(i);
    if (i > 0 && motion == motions.end()) {
      return absl::InvalidArgumentError(
          absl::StrCat(path, ": no odometry edge leads to vertex ", file.vertex_ids[i]));
    }
    if (i > 0) mission_from_body = mission_from_body * motion->second.from_tform_to;
    const int64_t period_ns = std::llround(1e9 / kDefaultRowRateHz);
    if (file.vertex_ids[i] > INT64_MAX / period_ns) {
      return absl::InvalidArgumentError(absl::StrCat(path, ": vertex id too large"));
    }
    recording.odometry.push_back({Timestamp{file.vertex_ids[i] * period_ns}, mission_from_body});
    recording.frames.push_back(file.vertex_ids[i]);
    recording.motion_covariances.push_back(i > 0 ? motion->second.covariance
                                                 : Matrix6d::Identity());
  }
  return recording;
}

absl::StatusOr<std::vector<FrameClosure>> ReadG2oClosures(const std::string& path,
                                                          bool kitti_camera) {
  G2oReadOptions options;
  options.out_of_plane_translation_information = std::pow(kOutOfPlaneTranslation_m, -2);
  options.out_of_plane_rotation_information = std::pow(kOutOfPlaneRotation_rad, -2);
  ASSIGN_OR_RETURN(const G2oFile file, ReadG2o(path, options));
  std::vector<FrameClosure> closures;
  for (const PoseGraphEdge& edge : file.graph.edges) {
    if (edge.kind != EdgeKind::kLoopClosure) continue;
    const FrameClosure closure = ToFrameClosure(file, edge);
    closures.push_back(kitti_camera && file.planar ? InOtherAxes(CameraFromGraph(), closure)
                                                   : closure);
  }
  return closures;
}

absl::StatusOr<Rigid3d> ReadAlignment(const std::string& path) {
  std::ifstream file(path);
  if (!file) return absl::NotFoundError(absl::StrCat(path, ": cannot be opened"));
  LineReader reader(file, path);
  std::vector<double> numbers;
  absl::string_view line;
  while (reader.Next(&line)) {
    for (const absl::string_view field :
         absl::StrSplit(line, absl::ByAnyChar(" \t,"), absl::SkipEmpty())) {
      const absl::StatusOr<double> number = ParseFiniteDouble(field);
      if (!number.ok()) return reader.Error(number.status().message());
      numbers.push_back(*number);
    }
  }
  RETURN_IF_ERROR(reader.status());
  if (numbers.size() != 12) {
    return absl::InvalidArgumentError(
        absl::StrCat(path, ": ", numbers.size(), " numbers where 12 are expected"));
  }
  const absl::StatusOr<Rigid3d> pose =
      CheckedPose(Eigen::Map<Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(numbers.data()));
  if (!pose.ok()) {
    return absl::InvalidArgumentError(absl::StrCat(path, ": ", pose.status().message()));
  }
  return *pose;
}

}  // namespace overtone
