// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/estimation/maximum_clique.h"

#include <algorithm>
#include <utility>

#include "overtone/core/estimation/core_order.h"

namespace overtone {
namespace {

// `clique` and, one after the other, the nodes of `order` (from its end) that are neighbours of all
// before.
std::vector<int> Extend(const BitGraph& graph, std::vector<int> clique, BitSet candidates,
                        const CoreOrder& order) {
  for (const int node : clique) candidates.Intersect(graph.Neighbours(node));
  for (auto node = order.nodes.rbegin(); node != order.nodes.rend(); ++node) {
    if (!candidates.Contains(*node)) continue;
    clique.push_back(*node);
    candidates.Intersect(graph.Neighbours(*node));
  }
  return clique;
}

// The subgraph on some nodes, renumbered in the order given.
BitGraph Induced(const BitGraph& graph, const std::vector<int>& nodes) {
  BitGraph induced(static_cast<int>(nodes.size()));
  std::vector<int> position(graph.NumNodes(), -1);
  for (size_t i = 0; i < nodes.size(); ++i) position[nodes[i]] = static_cast<int>(i);
  for (size_t i = 0; i < nodes.size(); ++i) {
    for (const int other : graph.Neighbours(nodes[i]).Elements()) {
      if (position[other] > static_cast<int>(i)) induced.Connect(i, position[other]);
    }
  }
  return induced;
}

class BranchAndBound {
 public:
  // Looks for cliques of more than `size` nodes.
  BranchAndBound(const BitGraph& graph, int size, const CliqueOptions& options)
      : graph_(graph), best_size_(size), options_(options) {}

  void Run() {
    BitSet all(graph_.NumNodes());
    for (int i = 0; i < graph_.NumNodes(); ++i) all.Insert(i);
    Expand(all);
  }

  // Empty when there is none.
  const std::vector<int>& Best() const { return best_; }
  // 0 when the search came to its end.
  int OpenBound() const { return open_bound_; }
  int64_t Branches() const { return branches_; }

 private:
  // Nodes of `candidates` with the number of colours that they and those before them need, greedily
  // (one colour after the other, each a set without edges). Nodes that need no more than
  // `irrelevant` colours are left out.
  struct Coloured {
    int node;
    int colour;
  };
  std::vector<Coloured> Colour(BitSet candidates, int irrelevant) const {
    std::vector<Coloured> order;
    for (int colour = 1; candidates.First() >= 0; ++colour) {
      BitSet uncoloured = candidates;
      for (int node = uncoloured.First(); node >= 0; node = uncoloured.First()) {
        uncoloured.Erase(node);
        uncoloured.Subtract(graph_.Neighbours(node));
        candidates.Erase(node);
        if (colour > irrelevant) order.push_back({node, colour});
      }
    }
    return order;
  }

  // Cliques of the present one and some of its common neighbours, `candidates`.
  void Expand(BitSet candidates) {
    const int size = static_cast<int>(clique_.size());
    const std::vector<Coloured> order = Colour(candidates, best_size_ - size);
    for (auto next = order.rbegin(); next != order.rend(); ++next) {
      if (size + next->colour <= best_size_) return;
      if (branches_ == options_.max_branches) {
        open_bound_ = std::max(open_bound_, size + next->colour);
        return;
      }
      ++branches_;
      clique_.push_back(next->node);
      if (size + 1 > best_size_) {
        best_ = clique_;
        best_size_ = size + 1;
      }
      BitSet rest = candidates;
      rest.Intersect(graph_.Neighbours(next->node));
      Expand(std::move(rest));
      clique_.pop_back();
      candidates.Erase(next->node);
    }
  }

  const BitGraph& graph_;
  int best_size_;
  const CliqueOptions& options_;
  std::vector<int> clique_;
  std::vector<int> best_;
  int open_bound_ = 0;
  int64_t branches_ = 0;
};

// The largest clique of `common` and some of `candidates`, which are neighbours of all of it; the
// extended clique `start` if none is larger.
Clique Search(const BitGraph& graph, const std::vector<int>& common, const BitSet& candidates,
              std::vector<int> start, const CliqueOptions& options) {
  const CoreOrder order = OrderByCore(graph, candidates);
  Clique result;
  result.members = Extend(graph, std::move(start), candidates, order);
  // From the densest part downwards, so that the best greedy clique comes early.
  for (size_t i = order.nodes.size(); i-- > 0;) {
    const int bound = static_cast<int>(common.size()) + order.core[i] + 1;
    if (bound <= static_cast<int>(result.members.size())) break;
    std::vector<int> greedy = common;
    greedy.push_back(order.nodes[i]);
    greedy = Extend(graph, std::move(greedy), candidates, order);
    if (greedy.size() > result.members.size()) result.members = std::move(greedy);
  }
  const int wanted = static_cast<int>(result.members.size()) - static_cast<int>(common.size());
  std::vector<int> relevant;  // from the densest part downwards
  for (size_t i = order.nodes.size(); i-- > 0 && order.core[i] >= wanted;) {
    relevant.push_back(order.nodes[i]);
  }
  const BitGraph induced = Induced(graph, relevant);
  BranchAndBound search(induced, wanted, options);
  search.Run();
  if (!search.Best().empty()) {
    result.members = common;
    for (const int i : search.Best()) result.members.push_back(relevant[i]);
  }
  std::sort(result.members.begin(), result.members.end());
  const int size = static_cast<int>(result.members.size());
  const int core_bound = order.core.empty() ? 0 : order.core.back() + 1;
  const int open_bound = std::min(search.OpenBound(), core_bound);
  result.upper_bound = std::max(size, static_cast<int>(common.size()) + open_bound);
  result.proven_maximum = result.upper_bound == size;
  result.branches = search.Branches();
  return result;
}

}  // namespace

absl::Status CliqueOptions::Validate() const {
  if (max_branches < 0) return absl::InvalidArgumentError("max_branches must not be negative");
  return absl::OkStatus();
}

Clique MaximumClique(const BitGraph& graph, const std::vector<int>& preferred,
                     const CliqueOptions& options) {
  BitSet all(graph.NumNodes()), allowed(graph.NumNodes());
  for (int i = 0; i < graph.NumNodes(); ++i) all.Insert(i);
  allowed = all;
  std::vector<int> start;
  for (const int node : preferred) {
    if (!allowed.Contains(node)) continue;
    start.push_back(node);
    allowed.Intersect(graph.Neighbours(node));
  }
  return Search(graph, {}, all, std::move(start), options);
}

Clique MaximumCliqueWithOneMore(const BitGraph& graph, int node, const Clique& known,
                                const CliqueOptions& options) {
  BitSet candidates(graph.NumNodes());
  for (int other = 0; other < node; ++other) candidates.Insert(other);
  candidates.Intersect(graph.Neighbours(node));
  std::vector<int> start = known.members;
  const bool joins = std::all_of(start.begin(), start.end(),
                                 [&](int member) { return candidates.Contains(member); });
  if (joins) start.push_back(node);
  Clique result = Search(graph, {node}, candidates, std::move(start), options);
  // Of the cliques without `node` the old bound holds; one with it is one more at most.
  const int size = static_cast<int>(result.members.size());
  result.upper_bound =
      std::max({size, known.upper_bound, std::min(known.upper_bound + 1, result.upper_bound)});
  result.proven_maximum = result.upper_bound == size;
  return result;
}

}  // namespace overtone
