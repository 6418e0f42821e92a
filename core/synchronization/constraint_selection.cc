// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/synchronization/constraint_selection.h"

#include "overtone/core/synchronization/chord_selection.h"
#include "overtone/core/synchronization/constraint_generation.h"
#include "overtone/core/synchronization/discrepancy_labels.h"
#include "overtone/core/synchronization/knot_selection.h"

namespace overtone {
namespace {

std::vector<Constraint> FromLabels(const TrajectoryComparison& comparison,
                                   const std::vector<DiscrepancyLabel>& labels,
                                   const ConstraintOptions& options) {
  std::vector<Constraint> constraints = ConstraintsAtScale(comparison, labels, options);
  for (Constraint& constraint : DegenerateConstraints(comparison, options)) {
    constraints.push_back(std::move(constraint));
  }
  return constraints;
}

}  // namespace

std::vector<Constraint> SelectConstraints(const TrajectoryComparison& comparison,
                                          const SynchronizationOptions& options,
                                          const SelectionContext& context) {
  const SelectionOptions& selection = options.selection;
  switch (selection.strategy) {
    case SelectionStrategy::kNone:
      return {};
    case SelectionStrategy::kTopN:
      return FromLabels(
          comparison,
          LargestDiscrepancies(comparison.discrepancy, selection.n, selection.min_discrepancy),
          options.constraints);
    case SelectionStrategy::kThreshold:
      return FromLabels(comparison,
                        DiscrepanciesAbove(comparison.discrepancy, selection.min_discrepancy),
                        options.constraints);
    case SelectionStrategy::kUniform:
      return UniformChords(comparison, options);
    case SelectionStrategy::kRandom:
      return RandomChords(comparison, options);
    case SelectionStrategy::kLargestEdgeError:
      return LargestEdgeErrors(comparison, options);
    case SelectionStrategy::kAll:
      return AllEdges(comparison, options);
    case SelectionStrategy::kKnots:
      return SelectKnots(comparison, options, context);
  }
  return {};
}

bool ProposesAll(SelectionStrategy strategy) { return strategy == SelectionStrategy::kKnots; }

}  // namespace overtone
