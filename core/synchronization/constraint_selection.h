// SPDX-License-Identifier: Apache-2.0
// Which constraints a comparison asks for: one interface for all strategies.
#ifndef OVERTONE_CORE_SYNCHRONIZATION_CONSTRAINT_SELECTION_H_
#define OVERTONE_CORE_SYNCHRONIZATION_CONSTRAINT_SELECTION_H_

#include <vector>

#include "overtone/core/synchronization/constraint.h"
#include "overtone/core/synchronization/selection_context.h"
#include "overtone/core/synchronization/synchronization_options.h"
#include "overtone/core/synchronization/trajectory_comparison.h"

namespace overtone {

// kTopN and kThreshold: discrepancy_labels.h, then constraint_generation.h; nodes flagged
// degenerate get theirs besides. kUniform, kRandom, kLargestEdgeError, kAll: chord_selection.h.
// kKnots: knot_selection.h, the only one that reads `context`. kNone: nothing. No id appears twice.
// The comparison has at least two nodes.
std::vector<Constraint> SelectConstraints(const TrajectoryComparison& comparison,
                                          const SynchronizationOptions& options,
                                          const SelectionContext& context = SelectionContext());

// What a comparison proposes is all that should be in force, so that what it does not propose any
// more has been superseded. Other strategies add to what earlier comparisons proposed.
bool ProposesAll(SelectionStrategy strategy);

}  // namespace overtone

#endif  // OVERTONE_CORE_SYNCHRONIZATION_CONSTRAINT_SELECTION_H_
