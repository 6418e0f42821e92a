// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/synchronization/constraint_generation.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace overtone {
namespace {

// Arc length from the first row to each row, on the server's poses.
std::vector<double> ArcLengths(const std::vector<Rigid3d>& poses) {
  std::vector<double> lengths(poses.size(), 0);
  for (int i = 1; i < poses.size(); ++i) {
    lengths[i] = lengths[i - 1] + (poses[i].translation - poses[i - 1].translation).norm();
  }
  return lengths;
}

// The submaps of a comparison, and which of them large constraints of a submap's nodes reach.
class SubmapNeighbors {
 public:
  SubmapNeighbors(const TrajectoryComparison& comparison, const ConstraintOptions& options)
      : comparison_(comparison),
        options_(options),
        pivots_(SubmapPivots(comparison.submap_start)),
        arc_length_(ArcLengths(comparison.server)) {
    int submap = -1;
    for (int row = 0; row < comparison.submap_start.size(); ++row) {
      if (row == 0 || comparison.submap_start[row]) ++submap;
      submap_of_row_.push_back(submap);
    }
  }

  std::vector<int> PivotsFor(int row) const {
    const int own = pivots_[submap_of_row_[row]];
    std::vector<std::pair<double, int>> candidates;
    for (const int pivot : pivots_) {
      const double distance =
          (comparison_.server[pivot].translation - comparison_.server[own].translation).norm();
      const double path = std::abs(arc_length_[pivot] - arc_length_[own]);
      if (pivot != own && pivot != row && distance >= options_.large_min_distance_m &&
          distance <= options_.large_max_distance_m && path >= options_.large_min_path_m) {
        candidates.emplace_back(distance, pivot);
      }
    }
    std::sort(candidates.begin(), candidates.end());
    candidates.resize(std::min<size_t>(candidates.size(), options_.large_neighbors));
    std::vector<int> neighbors;
    for (const auto& [distance, pivot] : candidates) neighbors.push_back(pivot);
    return neighbors;
  }

 private:
  const TrajectoryComparison& comparison_;
  const ConstraintOptions& options_;
  const std::vector<int> pivots_;
  const std::vector<double> arc_length_;
  std::vector<int> submap_of_row_;
};

ConstraintKind KindOf(Band band) {
  switch (band) {
    case Band::kLarge:
      return ConstraintKind::kLarge;
    case Band::kMid:
      return ConstraintKind::kMid;
    case Band::kSmall:
      return ConstraintKind::kSmall;
  }
  return ConstraintKind::kSmall;
}

std::vector<int> Targets(const DiscrepancyLabel& label, const SubmapNeighbors& submaps,
                         const ConstraintOptions& options) {
  const int i = label.node;
  switch (label.band) {
    case Band::kSmall:
      return {i - 1, i - 2, i + 1, i + 2};
    case Band::kMid:
      return {i - options.mid_hops, i + options.mid_hops};
    case Band::kLarge:
      return submaps.PivotsFor(i);
  }
  return {};
}

}  // namespace

Constraint ServerConstraint(const TrajectoryComparison& comparison, int from, int to,
                            ConstraintKind kind, double score, const ConstraintOptions& options) {
  Constraint constraint;
  constraint.kind = kind;
  constraint.from = comparison.keyframe_index[from];
  constraint.to = comparison.keyframe_index[to];
  constraint.id = ConstraintId(kind, constraint.from, constraint.to);
  constraint.from_tform_to = comparison.server[from].Inverse() * comparison.server[to];
  Vector6d variance;
  variance.head<3>().setConstant(options.sigma_translation_m * options.sigma_translation_m);
  variance.tail<3>().setConstant(options.sigma_rotation_rad * options.sigma_rotation_rad);
  constraint.covariance = variance.asDiagonal();
  constraint.score = score;
  constraint.revision = comparison.revision;
  return constraint;
}

std::vector<int> SubmapPivots(const std::vector<bool>& submap_start) {
  const int n = static_cast<int>(submap_start.size());
  std::vector<int> pivots;
  int begin = 0;
  for (int end = 1; end <= n; ++end) {
    if (end < n && !submap_start[end]) continue;
    pivots.push_back((begin + end) / 2);
    begin = end;
  }
  return pivots;
}

std::vector<Constraint> ConstraintsAtScale(const TrajectoryComparison& comparison,
                                           const std::vector<DiscrepancyLabel>& labels,
                                           const ConstraintOptions& options) {
  const SubmapNeighbors submaps(comparison, options);
  const int n = static_cast<int>(comparison.server.size());
  std::vector<Constraint> constraints;
  for (const DiscrepancyLabel& label : labels) {
    for (const int target : Targets(label, submaps, options)) {
      if (target < 0 || target >= n) continue;
      constraints.push_back(ServerConstraint(comparison, label.node, target, KindOf(label.band),
                                             label.discrepancy, options));
    }
  }
  return constraints;
}

std::vector<Constraint> DegenerateConstraints(const TrajectoryComparison& comparison,
                                              const ConstraintOptions& options) {
  std::vector<Constraint> constraints;
  for (int i = 1; i < comparison.degenerate.size(); ++i) {
    if (!comparison.degenerate[i]) continue;
    const double score = comparison.discrepancy(i, static_cast<int>(Band::kSmall));
    constraints.push_back(
        ServerConstraint(comparison, i - 1, i, ConstraintKind::kDegenerate, score, options));
  }
  return constraints;
}

}  // namespace overtone
