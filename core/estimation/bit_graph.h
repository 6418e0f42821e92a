// SPDX-License-Identifier: Apache-2.0
// A graph as one bit set of neighbours for each node: n^2 / 8 bytes.
#ifndef OVERTONE_CORE_ESTIMATION_BIT_GRAPH_H_
#define OVERTONE_CORE_ESTIMATION_BIT_GRAPH_H_

#include <vector>

#include "overtone/core/estimation/bit_set.h"

namespace overtone {

// Undirected, without loops.
class BitGraph {
 public:
  explicit BitGraph(int num_nodes = 0) : neighbours_(num_nodes, BitSet(num_nodes)) {}

  int NumNodes() const { return static_cast<int>(neighbours_.size()); }

  // Without neighbours at first. Returns its number, the one after the last.
  int AddNode() {
    const int node = NumNodes();
    neighbours_.emplace_back(node + 1);
    for (BitSet& neighbours : neighbours_) neighbours.Grow(node + 1);
    return node;
  }

  void Connect(int a, int b) {
    neighbours_[a].Insert(b);
    neighbours_[b].Insert(a);
  }
  bool AreConnected(int a, int b) const { return neighbours_[a].Contains(b); }
  const BitSet& Neighbours(int node) const { return neighbours_[node]; }

 private:
  std::vector<BitSet> neighbours_;
};

}  // namespace overtone

#endif  // OVERTONE_CORE_ESTIMATION_BIT_GRAPH_H_
