// SPDX-License-Identifier: Apache-2.0
// Where a graph is dense: the core number of a node is the largest k such that a part of the graph
// in which every node has k neighbours contains it. A clique of k + 1 nodes has core numbers of k
// and more. Matula & Beck, "Smallest-last ordering", J. ACM 30(3), 1983.
#ifndef OVERTONE_CORE_ESTIMATION_CORE_ORDER_H_
#define OVERTONE_CORE_ESTIMATION_CORE_ORDER_H_

#include <vector>

#include "overtone/core/estimation/bit_graph.h"

namespace overtone {

struct CoreOrder {
  std::vector<int> nodes;  // as they go when the one of smallest degree is removed again and again
  std::vector<int> core;   // of nodes[i]; not decreasing
};

// Of the subgraph on `candidates`.
CoreOrder OrderByCore(const BitGraph& graph, const BitSet& candidates);

}  // namespace overtone

#endif  // OVERTONE_CORE_ESTIMATION_CORE_ORDER_H_
