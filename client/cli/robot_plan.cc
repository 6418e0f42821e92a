// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/robot_plan.h"

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <map>
#include <utility>

#include "absl/strings/str_cat.h"

namespace overtone {
namespace {

std::optional<Rigid3d> GroundTruthAt(const Trajectory& ground_truth, Timestamp stamp) {
  const auto after =
      std::lower_bound(ground_truth.begin(), ground_truth.end(), stamp,
                       [](const StampedPose& pose, Timestamp time) { return pose.stamp < time; });
  if (after == ground_truth.end()) return std::nullopt;
  if (after->stamp == stamp) return after->pose;
  if (after == ground_truth.begin() ||
      SecondsBetween((after - 1)->stamp, after->stamp) > kMaxGroundTruthGap_s) {
    return std::nullopt;
  }
  const absl::StatusOr<Rigid3d> pose = Interpolate(ground_truth, stamp);
  return pose.ok() ? std::optional<Rigid3d>(*pose) : std::nullopt;
}

// Covariance of the motion from row `begin` to row `end`.
Matrix6d CovarianceBetween(const Recording& recording, int begin, int end,
                           const MotionNoise& noise) {
  Matrix6d covariance = Matrix6d::Zero();
  for (int row = begin + 1; row <= end; ++row) {
    const Rigid3d step = recording.odometry[row - 1].pose.Inverse() * recording.odometry[row].pose;
    covariance = CompoundCovariance(covariance, step,
                                    recording.motion_covariances.empty()
                                        ? MotionCovariance(step, noise)
                                        : recording.motion_covariances[row]);
  }
  return covariance;
}

// The row of `frame`; absent when this robot does not hold it.
std::optional<int> RowOf(const RobotPlan& plan, int64_t frame) {
  const auto found = std::lower_bound(plan.frames.begin(), plan.frames.end(), frame);
  if (found == plan.frames.end() || *found != frame) return std::nullopt;
  return static_cast<int>(found - plan.frames.begin());
}

// Keyframe whose row is nearest.
int NearestKeyframe(const RobotPlan& plan, int row) {
  const auto after = std::lower_bound(plan.rows.begin(), plan.rows.end(), row);
  if (after == plan.rows.begin()) return 0;
  const int index = static_cast<int>(after - plan.rows.begin());
  if (after == plan.rows.end()) return index - 1;
  return row - plan.rows[index - 1] <= *after - row ? index - 1 : index;
}

// Of this row itself.
std::optional<int64_t> KeyframeAt(const RobotPlan& plan, int row) {
  const int nearest = NearestKeyframe(plan, row);
  return plan.rows[nearest] == row ? std::optional<int64_t>(nearest) : std::nullopt;
}

std::vector<int> KeyframeRows(const Recording& recording, const RobotPlan& plan,
                              const KeyframeSelectionOptions& selection) {
  const std::vector<int> selected = SelectKeyframes(plan.odometry, selection);
  std::vector<int> wanted, rows;
  for (const int64_t frame : recording.keyframes) {
    if (const std::optional<int> row = RowOf(plan, frame)) wanted.push_back(*row);
  }
  std::set_union(selected.begin(), selected.end(), wanted.begin(), wanted.end(),
                 std::back_inserter(rows));
  return rows;
}

// Of the motion from row `begin` to row `end`: the last degenerate direction on the way counts.
void MarkDegenerate(const Recording& recording, const RobotPlan& plan, int begin, int end,
                    Keyframe* keyframe) {
  for (int row = begin + 1; row <= end && !recording.degenerate.empty(); ++row) {
    const auto degenerate = recording.degenerate.find(plan.frames[row]);
    if (degenerate == recording.degenerate.end()) continue;
    keyframe->degenerate = true;
    keyframe->degenerate_direction =
        (plan.odometry[end].Inverse() * plan.odometry[row]).rotation * degenerate->second;
  }
}

Rigid3d Between(const RobotPlan& plan, int from_row, int to_row) {
  return plan.odometry[from_row].Inverse() * plan.odometry[to_row];
}

}  // namespace

absl::StatusOr<RobotPlan> MakeRobotPlan(const Recording& recording,
                                        const KeyframeSelectionOptions& selection,
                                        const MotionNoise& noise) {
  RobotPlan plan;
  plan.name = recording.name;
  plan.id = recording.id;
  plan.common_from_world = recording.common_from_world;
  plan.odometry = Poses(recording.odometry);
  plan.stamps = Stamps(recording.odometry);
  plan.frames = recording.frames;
  plan.path_m = PathLength(plan.odometry);
  plan.ground_truth_positions_only = recording.ground_truth_positions_only;
  plan.rows = KeyframeRows(recording, plan, selection);
  if (plan.rows.size() < 2) {
    return absl::InvalidArgumentError(absl::StrCat(recording.name, ": fewer than two keyframes"));
  }
  int previous = 0;
  for (const int row : plan.rows) {
    Keyframe keyframe;
    keyframe.stamp = recording.odometry[row].stamp;
    keyframe.mission_from_body = plan.odometry[row];
    if (row > 0) keyframe.motion_covariance = CovarianceBetween(recording, previous, row, noise);
    MarkDegenerate(recording, plan, previous, row, &keyframe);
    plan.keyframes.push_back(keyframe);
    plan.ground_truth.push_back(GroundTruthAt(recording.ground_truth, keyframe.stamp));
    previous = row;
  }
  plan.observations = Placed(recording.observations, [&plan](int64_t frame) {
    const std::optional<int> row = RowOf(plan, frame);
    return row.has_value() ? KeyframeAt(plan, *row) : std::nullopt;
  });
  return plan;
}

std::optional<LoopClosure> PlaceClosure(const RobotPlan& from, int from_row, const RobotPlan& to,
                                        int to_row, const Rigid3d& from_tform_to,
                                        const Matrix6d& covariance) {
  const int from_keyframe = NearestKeyframe(from, from_row);
  const int to_keyframe = NearestKeyframe(to, to_row);
  LoopClosure placed;
  placed.from = {from.id, from_keyframe};
  placed.to = {to.id, to_keyframe};
  if (placed.from == placed.to) return std::nullopt;
  const Rigid3d row_from_keyframe = Between(to, to_row, to.rows[to_keyframe]);
  placed.from_tform_to =
      Between(from, from.rows[from_keyframe], from_row) * from_tform_to * row_from_keyframe;
  placed.covariance = CompoundCovariance(covariance, row_from_keyframe, Matrix6d::Zero());
  return placed;
}

std::vector<LoopClosure> PlaceClosures(const std::vector<FrameClosure>& closures,
                                       const std::vector<RobotPlan>& plans) {
  std::vector<LoopClosure> result;
  for (const FrameClosure& closure : closures) {
    for (const RobotPlan& from : plans) {
      for (const RobotPlan& to : plans) {
        const std::optional<int> from_row = RowOf(from, closure.from_frame);
        const std::optional<int> to_row = RowOf(to, closure.to_frame);
        if (!from_row.has_value() || !to_row.has_value()) continue;
        const std::optional<LoopClosure> placed =
            PlaceClosure(from, *from_row, to, *to_row, closure.from_tform_to, closure.covariance);
        if (placed.has_value()) result.push_back(*placed);
      }
    }
  }
  return result;
}

std::vector<ScoredCandidate> PlaceCandidates(const std::vector<FrameCandidate>& candidates,
                                             const std::vector<RobotPlan>& plans) {
  std::map<std::pair<NodeId, NodeId>, double> best;
  for (const FrameCandidate& candidate : candidates) {
    for (const RobotPlan& from : plans) {
      for (const RobotPlan& to : plans) {
        const std::optional<int> from_row = RowOf(from, candidate.from_frame);
        const std::optional<int> to_row = RowOf(to, candidate.to_frame);
        if (!from_row.has_value() || !to_row.has_value()) continue;
        const NodeId from_node = {from.id, NearestKeyframe(from, *from_row)};
        const NodeId to_node = {to.id, NearestKeyframe(to, *to_row)};
        if (from_node == to_node) continue;
        double& score = best[{from_node, to_node}];
        score = std::max(score, candidate.score);
      }
    }
  }
  std::vector<ScoredCandidate> result;
  for (const auto& [ends, score] : best) result.push_back({ends.first, ends.second, score});
  return result;
}

}  // namespace overtone
