// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <numeric>
#include <set>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/spectral/graph_laplacian.h"
#include "overtone/core/spectral/kept_nodes.h"
#include "overtone/core/spectral/kron_reduction.h"

namespace overtone {
namespace {

struct Neighbor {
  int node;
  double weight;
};
using Star = std::vector<Neighbor>;  // by increasing node

double TotalWeight(const Star& star) {
  return std::accumulate(star.begin(), star.end(), 0.0, [](double sum, const Neighbor& neighbor) {
    return sum + neighbor.weight;
  });
}

// The graph while nodes are taken out of it one by one.
class EliminationGraph {
 public:
  EliminationGraph(const SparseMatrix& laplacian, double relative_tolerance)
      : stars_(laplacian.cols()) {
    for (int node = 0; node < laplacian.cols(); ++node) {
      for (SparseMatrix::InnerIterator entry(laplacian, node); entry; ++entry) {
        if (entry.row() != node && entry.value() < 0) {
          stars_[node].push_back({static_cast<int>(entry.row()), -entry.value()});
        }
      }
      for (const Neighbor& neighbor : stars_[node]) {
        smallest_weight_ = std::max(smallest_weight_, relative_tolerance * neighbor.weight);
      }
    }
  }

  const Star& star(int node) const { return stars_[node]; }
  int NumNeighbors(int node) const { return static_cast<int>(stars_[node].size()); }
  double dropped_weight() const { return dropped_weight_; }

  // Replaces the star of `center` by the mesh between its neighbours, and returns them.
  Star Eliminate(int center) {
    const Star star = std::move(stars_[center]);
    stars_[center].clear();
    const double total = TotalWeight(star);
    const int heaviest =
        std::max_element(star.begin(), star.end(), [](const Neighbor& a, const Neighbor& b) {
          return a.weight < b.weight;
        })->node;
    for (const Neighbor& end : star) {
      stars_[end.node] = Merge(stars_[end.node], end, star, center, total, heaviest);
    }
    return star;
  }

 private:
  // `old` without the center, plus the mesh edges at `end`. Both lists are sorted.
  Star Merge(const Star& old, const Neighbor& end, const Star& mesh, int center, double total,
             int heaviest) {
    Star merged;
    merged.reserve(old.size() + mesh.size());
    auto kept = old.begin();
    for (const Neighbor& other : mesh) {
      for (; kept != old.end() && kept->node < other.node; ++kept) {
        if (kept->node != center) merged.push_back(*kept);
      }
      if (other.node == end.node) continue;
      // The same at both ends, and no product of two tiny numbers.
      const double weight =
          std::min(end.weight, other.weight) * (std::max(end.weight, other.weight) / total);
      if (kept != old.end() && kept->node == other.node) {
        merged.push_back({other.node, kept->weight + weight});
        ++kept;
      } else if (other.node == heaviest || end.node == heaviest || weight >= smallest_weight_) {
        merged.push_back({other.node, weight});
      } else {
        dropped_weight_ += 0.5 * weight;  // the other end counts it too
      }
    }
    for (; kept != old.end(); ++kept) {
      if (kept->node != center) merged.push_back(*kept);
    }
    return merged;
  }

  std::vector<Star> stars_;
  double smallest_weight_ = 0;  // of a new edge
  double dropped_weight_ = 0;
};

// Fewest neighbours first, the count kept up to date.
void EliminateAll(const std::vector<int>& nodes, EliminationGraph& graph) {
  std::set<std::pair<int, int>> queue;  // (number of neighbours, node)
  std::vector<int> queued_with;
  for (const int node : nodes) {
    queue.emplace(graph.NumNeighbors(node), node);
    if (node >= static_cast<int>(queued_with.size())) queued_with.resize(node + 1, -1);
    queued_with[node] = graph.NumNeighbors(node);
  }
  while (!queue.empty()) {
    const int center = queue.begin()->second;
    queue.erase(queue.begin());
    queued_with[center] = -1;
    for (const Neighbor& neighbor : graph.Eliminate(center)) {
      const int node = neighbor.node;
      if (node >= static_cast<int>(queued_with.size()) || queued_with[node] < 0) continue;
      if (queued_with[node] == graph.NumNeighbors(node)) continue;
      queue.erase({queued_with[node], node});
      queued_with[node] = graph.NumNeighbors(node);
      queue.emplace(queued_with[node], node);
    }
  }
}

}  // namespace

absl::StatusOr<KronReductionResult> SparsifiedKronReduction(const SparseMatrix& laplacian,
                                                            const std::vector<int>& kept_nodes,
                                                            double relative_tolerance) {
  if (!(relative_tolerance >= 0) || !(relative_tolerance < 1)) {
    return absl::InvalidArgumentError(
        absl::StrCat("relative_tolerance: ", relative_tolerance, " is not in [0, 1)"));
  }
  ASSIGN_OR_RETURN(const NodePartition partition, PartitionNodes(laplacian, kept_nodes));
  EliminationGraph graph(laplacian, relative_tolerance);
  EliminateAll(partition.eliminated, graph);

  const int num_kept = static_cast<int>(kept_nodes.size());
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < num_kept; ++i) {
    for (const Neighbor& neighbor : graph.star(kept_nodes[i])) {
      entries.emplace_back(i, partition.position[neighbor.node], neighbor.weight);
    }
  }
  SparseMatrix adjacency(num_kept, num_kept);
  adjacency.setFromTriplets(entries.begin(), entries.end());
  KronReductionResult result;
  result.laplacian = GraphLaplacian(adjacency);
  const double total_weight = 0.5 * laplacian.diagonal().sum();
  if (total_weight > 0) result.dropped_weight_fraction = graph.dropped_weight() / total_weight;
  return result;
}

}  // namespace overtone
