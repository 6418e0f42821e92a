// SPDX-License-Identifier: Apache-2.0
// First guess of a pose graph by composing measurements along a spanning tree.
#ifndef OVERTONE_CORE_ESTIMATION_SPANNING_TREE_INITIALISATION_H_
#define OVERTONE_CORE_ESTIMATION_SPANNING_TREE_INITIALISATION_H_

#include <vector>

#include "overtone/core/graph/pose_graph.h"

namespace overtone {

// The first pose of every component stays as given; the others follow from it, over odometry
// wherever odometry leads and over a loop closure only where nothing else does. Edges must be
// within range.
std::vector<Rigid3d> SpanningTreeInitialisation(const PoseGraph& graph);

}  // namespace overtone

#endif  // OVERTONE_CORE_ESTIMATION_SPANNING_TREE_INITIALISATION_H_
