// SPDX-License-Identifier: Apache-2.0
// Baselines: constraints placed without looking at the wavelets.
#ifndef OVERTONE_CORE_SYNCHRONIZATION_CHORD_SELECTION_H_
#define OVERTONE_CORE_SYNCHRONIZATION_CHORD_SELECTION_H_

#include <vector>

#include "overtone/core/synchronization/constraint.h"
#include "overtone/core/synchronization/synchronization_options.h"
#include "overtone/core/synchronization/trajectory_comparison.h"

namespace overtone {

// How much the relative pose of two rows differs between server and robot, in the se3 metric of
// `weights`.
double RelativePoseDiscrepancy(const TrajectoryComparison& comparison, int from, int to,
                               const MetricWeights& weights);

// n chords between consecutive knots, which lie on the nodes nearest to equal shares of the path;
// fewer where shares meet in one node.
std::vector<Constraint> UniformChords(const TrajectoryComparison& comparison,
                                      const SynchronizationOptions& options);

// n chords between different random nodes; the same for the same seed and number of nodes on every
// platform. Fewer where there are not as many pairs.
std::vector<Constraint> RandomChords(const TrajectoryComparison& comparison,
                                     const SynchronizationOptions& options);

// The n consecutive pairs of the largest RelativePoseDiscrepancy, in order along the mission.
std::vector<Constraint> LargestEdgeErrors(const TrajectoryComparison& comparison,
                                          const SynchronizationOptions& options);

// Every consecutive pair.
std::vector<Constraint> AllEdges(const TrajectoryComparison& comparison,
                                 const SynchronizationOptions& options);

}  // namespace overtone

#endif  // OVERTONE_CORE_SYNCHRONIZATION_CHORD_SELECTION_H_
