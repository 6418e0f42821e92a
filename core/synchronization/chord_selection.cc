// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/synchronization/chord_selection.h"

#include <algorithm>
#include <random>
#include <set>
#include <utility>

#include "overtone/core/synchronization/constraint_generation.h"

namespace overtone {
namespace {

Constraint Edge(const TrajectoryComparison& comparison, int from, int to, ConstraintKind kind,
                const SynchronizationOptions& options) {
  const double score = RelativePoseDiscrepancy(comparison, from, to, options.signal_weights);
  return ServerConstraint(comparison, from, to, kind, score, options.constraints);
}

}  // namespace

double RelativePoseDiscrepancy(const TrajectoryComparison& comparison, int from, int to,
                               const MetricWeights& weights) {
  return PoseDistance(comparison.server[from].Inverse() * comparison.server[to],
                      comparison.onboard[from].Inverse() * comparison.onboard[to],
                      DistanceMetric::kSe3, weights);
}

std::vector<Constraint> UniformChords(const TrajectoryComparison& comparison,
                                      const SynchronizationOptions& options) {
  // A node counts a micrometre even where the robot stands, so that every mission can be cut.
  constexpr double kMinStep = 1e-6;
  std::vector<double> path = {0};
  for (int i = 1; i < comparison.server.size(); ++i) {
    const Eigen::Vector3d step =
        comparison.server[i].translation - comparison.server[i - 1].translation;
    path.push_back(path.back() + std::max(step.norm(), kMinStep));
  }
  std::vector<Constraint> chords;
  int from = 0;
  for (int k = 1; k <= options.selection.n; ++k) {
    const double share = path.back() * k / options.selection.n;
    int to = static_cast<int>(std::lower_bound(path.begin(), path.end(), share) - path.begin());
    to = std::min(to, static_cast<int>(path.size()) - 1);
    if (to > 0 && share - path[to - 1] < path[to] - share) --to;
    if (to <= from) continue;
    chords.push_back(Edge(comparison, from, to, ConstraintKind::kChord, options));
    from = to;
  }
  return chords;
}

std::vector<Constraint> RandomChords(const TrajectoryComparison& comparison,
                                     const SynchronizationOptions& options) {
  const uint64_t num_nodes = comparison.server.size();
  const uint64_t num_pairs = num_nodes * (num_nodes - 1) / 2;
  const uint64_t num_chords = std::min<uint64_t>(options.selection.n, num_pairs);
  // Not std::uniform_int_distribution, whose numbers the standard leaves open. The modulo's bias is
  // below 1e-14.
  std::mt19937_64 random(options.selection.seed);
  std::set<std::pair<int, int>> pairs;
  while (pairs.size() < num_chords) {
    const int a = static_cast<int>(random() % num_nodes);
    const int b = static_cast<int>(random() % num_nodes);
    if (a != b) pairs.insert(std::minmax(a, b));
  }
  std::vector<Constraint> chords;
  for (const auto& [from, to] : pairs) {
    chords.push_back(Edge(comparison, from, to, ConstraintKind::kChord, options));
  }
  return chords;
}

std::vector<Constraint> AllEdges(const TrajectoryComparison& comparison,
                                 const SynchronizationOptions& options) {
  std::vector<Constraint> edges;
  for (int i = 1; i < comparison.server.size(); ++i) {
    edges.push_back(Edge(comparison, i - 1, i, ConstraintKind::kSmall, options));
  }
  return edges;
}

std::vector<Constraint> LargestEdgeErrors(const TrajectoryComparison& comparison,
                                          const SynchronizationOptions& options) {
  std::vector<Constraint> edges = AllEdges(comparison, options);
  std::stable_sort(edges.begin(), edges.end(),
                   [](const Constraint& a, const Constraint& b) { return a.score > b.score; });
  edges.resize(std::min<size_t>(edges.size(), options.selection.n));
  std::sort(edges.begin(), edges.end(),
            [](const Constraint& a, const Constraint& b) { return a.from < b.from; });
  return edges;
}

}  // namespace overtone
