// SPDX-License-Identifier: Apache-2.0
// The fewest chords that bring the onboard estimate to the server's: the mission is cut at knots,
// placed such that the predicted result of tying consecutive ones together is nearest to the
// server's estimate.
#ifndef OVERTONE_CORE_SYNCHRONIZATION_KNOT_SELECTION_H_
#define OVERTONE_CORE_SYNCHRONIZATION_KNOT_SELECTION_H_

#include <vector>

#include "overtone/core/synchronization/chord_prediction.h"
#include "overtone/core/synchronization/constraint.h"
#include "overtone/core/synchronization/selection_context.h"
#include "overtone/core/synchronization/synchronization_options.h"
#include "overtone/core/synchronization/trajectory_comparison.h"

namespace overtone {

// Chords between consecutive knots, all that should be in force: those of context.active that are
// not among them have been superseded. None where odometry alone is within selection.tolerance_m of
// the server's estimate; else as few as come within it, and at most selection.n. Knots that are in
// force stay unless moving them gains more than a tenth of what is left, or of the tolerance;
// whether it does is first asked of small changes of them, and only where one does (or where there
// are too many or too few) of the whole mission.
//
// O(nodes), with a large constant: a search looks at a bounded number of candidates and samples,
// some ten to thirty times at all nodes. Knots that stay cost a sixth of a search.
//
// A chord's standard deviations are those of the options, but no more than a thirtieth of
// odometry's over the chord (per axis): the server's estimate has the robot's odometry in it
// already, so that a chord that odometry could pull away from it would count odometry twice. It
// leaves a thousandth of the gap.
std::vector<Constraint> SelectKnots(const TrajectoryComparison& comparison,
                                    const SynchronizationOptions& options,
                                    const SelectionContext& context);

// The prediction for a comparison: by the context's odometry, else the host's estimate and the
// options' model.
ChordPrediction PredictionFor(const TrajectoryComparison& comparison,
                              const SynchronizationOptions& options,
                              const SelectionContext& context);

// Rows of the knots of `constraints` when they are chords that join consecutive knots, in any
// order; empty when they are not, or when a knot is not among the rows.
std::vector<int> KnotRows(const TrajectoryComparison& comparison,
                          const std::vector<Constraint>& constraints);

}  // namespace overtone

#endif  // OVERTONE_CORE_SYNCHRONIZATION_KNOT_SELECTION_H_
