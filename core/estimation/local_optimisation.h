// SPDX-License-Identifier: Apache-2.0
// Optimises a graph that was optimised before and has changed in places: only what is not at rest,
// and what moves with it.
//
// The active set begins with the poses that would gain most by moving alone (pose_graph_unrest.h)
// and their neighbours over a few edges; what borders on it stays. It is solved, and where its
// border is then not at rest it grows, each time by twice as many edges, until all is. So a change
// that dies out in its neighbourhood costs that neighbourhood, and one that bends the whole graph
// costs little more than a solve of the whole.
#ifndef OVERTONE_CORE_ESTIMATION_LOCAL_OPTIMISATION_H_
#define OVERTONE_CORE_ESTIMATION_LOCAL_OPTIMISATION_H_

#include <optional>

#include "absl/status/statusor.h"
#include "overtone/core/estimation/pose_graph_optimizer.h"

namespace overtone {

struct LocalOptimisationOptions {
  // All is at rest when moving each pose alone would lower the cost by less than this share of it,
  // all of them together and times the reach so far: over a border at that distance poses gain by
  // moving together up to so many times what they gain alone. What cycles leave adds up until the
  // whole is solved: to a few times this share.
  double rest_share = 1.5e-7;
  // Edges between what is not at rest and the border, at first.
  int first_reach = 4;
  // Of the poses: with more active ones the whole is solved.
  double largest_share = 0.25;
};

// The result of OptimizePoseGraph on the whole graph from the given poses and weights, to within
// rest_share; nullopt when the whole has to be solved: too much has to move, a measurement gains or
// loses its weight, or the loss is neither none nor graduated. The same errors as
// OptimizePoseGraph; `options.held` must be empty, its initialisation kGiven.
absl::StatusOr<std::optional<PoseGraphResult>> OptimizeLocally(
    const PoseGraph& graph, const PoseGraphOptimizerOptions& options,
    const LocalOptimisationOptions& local = {});

}  // namespace overtone

#endif  // OVERTONE_CORE_ESTIMATION_LOCAL_OPTIMISATION_H_
