// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/synchronization/host_prediction.h"

#include <algorithm>
#include <cstdint>
#include <set>
#include <utility>

#include "Eigen/Cholesky"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/synchronization/aligned_rmse.h"
#include "overtone/core/synchronization/chain_smoother.h"

namespace overtone {
namespace {

// More make a prediction dearer and no better.
constexpr int kMaxRows = 2000;

bool IndexBefore(const NodePose& node, int64_t index) { return node.index < index; }

// -1: there is none.
int PositionOf(const std::vector<NodePose>& nodes, int64_t index) {
  const auto node = std::lower_bound(nodes.begin(), nodes.end(), index, IndexBefore);
  if (node == nodes.end() || node->index != index) return -1;
  return static_cast<int>(node - nodes.begin());
}

// A node of the host's, and the comparison's row that it is; -1: between two of them.
struct HostNodes {
  std::vector<NodePose> nodes;
  std::vector<int> rows;
};

// Rows, and the keyframes between them at which constraints end.
HostNodes NodesOf(const TrajectoryComparison& comparison, const std::vector<Constraint>& in_force) {
  std::set<int64_t> ends;
  for (const Constraint& constraint : in_force) ends.insert({constraint.from, constraint.to});
  HostNodes result;
  const auto add = [&result](const NodePose& node, int row) {
    result.nodes.push_back(node);
    result.rows.push_back(row);
  };
  const int size = static_cast<int>(comparison.onboard.size());
  const int stride = (size + kMaxRows - 1) / kMaxRows;
  auto between = comparison.unmatched.begin();
  for (int i = 0; i < size; ++i) {
    const int64_t index = comparison.keyframe_index[i];
    for (; between != comparison.unmatched.end() && between->index < index; ++between) {
      if (ends.count(between->index) > 0) add(*between, -1);
    }
    if (i % stride == 0 || i == size - 1 || ends.count(index) > 0) {
      add({index, Timestamp(), comparison.onboard[i]}, i);
    }
  }
  for (; between != comparison.unmatched.end(); ++between) {
    if (ends.count(between->index) > 0) add(*between, -1);
  }
  return result;
}

std::vector<OdometryStep> StepsOf(const OdometryChain& chain) {
  std::vector<OdometryStep> steps(chain.poses.size());
  for (int i = 1; i < steps.size(); ++i) {
    steps[i].previous_from_this = chain.poses[i - 1].Inverse() * chain.poses[i];
    steps[i].covariance = chain.step_covariance[i];
    steps[i].information = chain.step_covariance[i].llt().solve(Matrix6d::Identity());
  }
  return steps;
}

std::vector<Chord> ChordsOf(const std::vector<NodePose>& nodes,
                            const std::vector<Constraint>& in_force) {
  std::vector<Chord> chords;
  for (const Constraint& constraint : in_force) {
    Chord chord;
    chord.from = PositionOf(nodes, constraint.from);
    chord.to = PositionOf(nodes, constraint.to);
    if (chord.from < 0 || chord.to < 0) continue;
    chord.from_tform_to = constraint.from_tform_to;
    chord.information = constraint.covariance.llt().solve(Matrix6d::Identity());
    chords.push_back(chord);
  }
  return chords;
}

}  // namespace

std::vector<NodePose> RowsOf(const TrajectoryComparison& comparison) {
  std::vector<NodePose> rows;
  rows.reserve(comparison.onboard.size());
  for (int i = 0; i < comparison.onboard.size(); ++i) {
    rows.push_back({comparison.keyframe_index[i], Timestamp(), comparison.onboard[i]});
  }
  return rows;
}

absl::StatusOr<HostPrediction> PredictHost(const TrajectoryComparison& comparison,
                                           const OdometryRecord& record, const OdometryModel& model,
                                           const std::vector<Constraint>& in_force) {
  const auto [nodes, rows] = NodesOf(comparison, in_force);
  std::vector<Rigid3d> start;
  for (const NodePose& node : nodes) start.push_back(node.estimate_from_body);
  // Apart, so that the record's chain has gone before the smoother needs its memory.
  const std::vector<OdometryStep> steps = StepsOf(record.Along(nodes, model));
  ASSIGN_OR_RETURN(const ChainSmootherResult smoothed,
                   SmoothChain(start, steps, ChordsOf(nodes, in_force), ChainSmootherOptions()));
  HostPrediction prediction;
  for (int i = 0; i < nodes.size(); ++i) {
    if (rows[i] < 0) continue;
    prediction.rows.push_back(rows[i]);
    prediction.poses.push_back(smoothed.poses[i]);
  }
  prediction.rmse_m = AlignedRmse(prediction.poses, prediction.Of(comparison.server));
  return prediction;
}

std::vector<Rigid3d> HostPrediction::Of(const std::vector<Rigid3d>& values) const {
  std::vector<Rigid3d> result;
  result.reserve(rows.size());
  for (const int row : rows) result.push_back(values[row]);
  return result;
}

}  // namespace overtone
