// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/estimation/core_order.h"

#include <algorithm>

namespace overtone {

CoreOrder OrderByCore(const BitGraph& graph, const BitSet& candidates) {
  CoreOrder order;
  std::vector<int> degree(graph.NumNodes(), 0);
  std::vector<std::vector<int>> buckets(graph.NumNodes() + 1);  // by degree; old entries stay
  BitSet left = candidates;
  for (const int node : candidates.Elements()) {
    BitSet neighbours = graph.Neighbours(node);
    neighbours.Intersect(candidates);
    degree[node] = neighbours.Size();
    buckets[degree[node]].push_back(node);
  }
  int core = 0;
  for (int d = 0; d < static_cast<int>(buckets.size());) {
    if (buckets[d].empty()) {
      ++d;
      continue;
    }
    const int node = buckets[d].back();
    buckets[d].pop_back();
    if (!left.Contains(node) || degree[node] != d) continue;
    core = std::max(core, d);
    left.Erase(node);
    order.nodes.push_back(node);
    order.core.push_back(core);
    BitSet neighbours = graph.Neighbours(node);
    neighbours.Intersect(left);
    for (const int other : neighbours.Elements()) buckets[--degree[other]].push_back(other);
    d = std::max(0, d - 1);
  }
  return order;
}

}  // namespace overtone
