// SPDX-License-Identifier: Apache-2.0
// From a label (node, band) to relative-pose constraints at that scale, taken from the server's
// poses. Bernreiter et al. 2024, "Constraint generation".
#ifndef OVERTONE_CORE_SYNCHRONIZATION_CONSTRAINT_GENERATION_H_
#define OVERTONE_CORE_SYNCHRONIZATION_CONSTRAINT_GENERATION_H_

#include <vector>

#include "overtone/core/synchronization/constraint.h"
#include "overtone/core/synchronization/discrepancy_labels.h"
#include "overtone/core/synchronization/synchronization_options.h"
#include "overtone/core/synchronization/trajectory_comparison.h"

namespace overtone {

// The constraint between rows `from` and `to` of the comparison: server_from^-1 * server_to.
Constraint ServerConstraint(const TrajectoryComparison& comparison, int from, int to,
                            ConstraintKind kind, double score, const ConstraintOptions& options);

// Rows of the submaps' pivots: the middle node (start + end) / 2 of each run that `submap_start`
// opens. The first row always opens one.
std::vector<int> SubmapPivots(const std::vector<bool>& submap_start);

// For each label in order:
//   small: i to i-1, i-2, i+1, i+2     mid: i to i-hops, i+hops     large: i to the pivots of other
//   submaps that
// ConstraintOptions describes, nearest first. What lies outside the mission is left out.
std::vector<Constraint> ConstraintsAtScale(const TrajectoryComparison& comparison,
                                           const std::vector<DiscrepancyLabel>& labels,
                                           const ConstraintOptions& options);

// Across stretches the robot flagged degenerate: i-1 to i for every flagged i. Its score is the
// small band's entry.
std::vector<Constraint> DegenerateConstraints(const TrajectoryComparison& comparison,
                                              const ConstraintOptions& options);

}  // namespace overtone

#endif  // OVERTONE_CORE_SYNCHRONIZATION_CONSTRAINT_GENERATION_H_
