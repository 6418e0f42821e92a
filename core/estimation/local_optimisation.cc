// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/estimation/local_optimisation.h"

#include <algorithm>
#include <chrono>
#include <numeric>
#include <utility>
#include <vector>

#include "overtone/core/common/status_macros.h"
#include "overtone/core/estimation/active_set.h"
#include "overtone/core/estimation/connected_components.h"
#include "overtone/core/estimation/pose_graph_unrest.h"

namespace overtone {
namespace {

using Clock = std::chrono::steady_clock;

// Of a gain: a map without contradictions has a cost of nothing.
constexpr double kRoundOff = 1e-12;

// One for each measurement, edges first.
std::vector<double> InitialWeights(const PoseGraph& graph,
                                   const PoseGraphOptimizerOptions& options) {
  const size_t num_measurements = graph.edges.size() + graph.sightings.size();
  if (options.loss == RobustLoss::kNone) return std::vector<double>(num_measurements, 1);
  std::vector<double> weights = options.initial_weights;
  weights.resize(graph.edges.size(), 1);
  weights.insert(weights.end(), options.initial_sighting_weights.begin(),
                 options.initial_sighting_weights.end());
  weights.resize(num_measurements, 1);
  return weights;
}

class LocalRun {
 public:
  LocalRun(const PoseGraph& graph, const PoseGraphOptimizerOptions& options,
           const LocalOptimisationOptions& local)
      : graph_(graph),
        options_(options),
        local_(local),
        num_variables_(static_cast<int>(graph.poses.size() + graph.landmarks.size())),
        unrest_(graph, InitialWeights(graph, options)),
        active_(graph) {
    result_.poses = graph.poses;
    result_.landmarks = graph.landmarks;
    for (int k = 0; k < static_cast<int>(unrest_.weights().size()); ++k) Update(k);
  }

  absl::StatusOr<std::optional<PoseGraphResult>> Run() {
    result_.initial_cost = cost_ = unrest_.Cost();
    result_.converged = true;
    std::vector<int> candidates(num_variables_);
    std::iota(candidates.begin(), candidates.end(), 0);
    for (int reach = local_.first_reach;; reach *= 2) {
      const std::vector<int> seeds = NotAtRest(candidates, reach);
      if (seeds.empty()) break;
      active_.Grow(seeds, reach);
      if (active_.NumActive() > local_.largest_share * num_variables_) return std::nullopt;
      ASSIGN_OR_RETURN(const bool weights_hold, SolveActive());
      if (!weights_hold) return std::nullopt;
      candidates = active_.border();
    }
    Finish();
    return std::make_optional(std::move(result_));
  }

 private:
  void Update(int measurement) { unrest_.Update(measurement, result_.poses, result_.landmarks); }

  // Those that gain most, so many that the others together gain next to nothing; none when all do.
  std::vector<int> NotAtRest(const std::vector<int>& candidates, int reach) const {
    std::vector<std::pair<double, int>> gains;
    double left = 0;
    for (const int variable : candidates) {
      gains.emplace_back(unrest_.GainAlone(variable), variable);
      left += gains.back().first;
    }
    const double at_rest = local_.rest_share * cost_ / reach + kRoundOff;
    std::vector<int> seeds;
    if (left <= at_rest) return seeds;
    std::sort(gains.rbegin(), gains.rend());
    for (const auto& [gain, variable] : gains) {
      if (left <= 0.5 * at_rest) break;
      seeds.push_back(variable);
      left -= gain;
    }
    return seeds;
  }

  // False: the solution wants other weights.
  absl::StatusOr<bool> SolveActive() {
    const ActiveSet::Part part = active_.Extract(result_.poses, result_.landmarks);
    const size_t num_edges = part.graph.edges.size();
    PoseGraphOptimizerOptions options = options_;
    options.held = part.held;
    options.initial_weights.clear();
    options.initial_sighting_weights.clear();
    for (size_t k = 0; k < part.measurements.size(); ++k) {
      (k < num_edges ? options.initial_weights : options.initial_sighting_weights)
          .push_back(unrest_.weights()[part.measurements[k]]);
    }
    ASSIGN_OR_RETURN(const PoseGraphResult solved, OptimizePoseGraph(part.graph, options));
    if (options_.loss != RobustLoss::kNone &&
        (solved.weights != options.initial_weights ||
         solved.sighting_weights != options.initial_sighting_weights)) {
      return false;
    }
    const int num_poses = static_cast<int>(graph_.poses.size());
    const size_t num_part_poses = part.graph.poses.size();
    for (size_t i = 0; i < part.variables.size(); ++i) {
      if (part.held[i]) continue;
      if (i < num_part_poses) {
        result_.poses[part.variables[i]] = solved.poses[i];
      } else {
        result_.landmarks[part.variables[i] - num_poses] = solved.landmarks[i - num_part_poses];
      }
    }
    for (const int measurement : part.measurements) Update(measurement);
    cost_ = unrest_.Cost();
    result_.iterations += solved.iterations;
    result_.converged = solved.converged;
    return true;
  }

  void Finish() {
    const auto split = static_cast<int64_t>(graph_.edges.size());
    const std::vector<double>& weights = unrest_.weights();
    const std::vector<double>& chi_squares = unrest_.chi_squares();
    result_.weights.assign(weights.begin(), weights.begin() + split);
    result_.sighting_weights.assign(weights.begin() + split, weights.end());
    result_.chi_squares.assign(chi_squares.begin(), chi_squares.begin() + split);
    result_.sighting_chi_squares.assign(chi_squares.begin() + split, chi_squares.end());
    result_.final_cost = cost_;
    result_.number_of_components = NumComponents();
    result_.seconds = std::chrono::duration<double>(Clock::now() - begin_).count();
  }

  int NumComponents() const {
    ConnectedComponents components(num_variables_);
    const int num_poses = static_cast<int>(graph_.poses.size());
    for (const PoseGraphEdge& edge : graph_.edges) components.Unite(edge.from, edge.to);
    for (const PointSighting& sighting : graph_.sightings) {
      components.Unite(sighting.pose, sighting.landmark >= 0 ? num_poses + sighting.landmark
                                                             : sighting.target_pose);
    }
    int count = 0;
    for (int i = 0; i < num_poses; ++i) count += components.Representative(i) == i;
    return count;
  }

  const PoseGraph& graph_;
  const PoseGraphOptimizerOptions& options_;
  const LocalOptimisationOptions& local_;
  const int num_variables_;
  const Clock::time_point begin_ = Clock::now();
  double cost_ = 0;
  PoseGraphUnrest unrest_;
  ActiveSet active_;
  PoseGraphResult result_;
};

}  // namespace

absl::StatusOr<std::optional<PoseGraphResult>> OptimizeLocally(
    const PoseGraph& graph, const PoseGraphOptimizerOptions& options,
    const LocalOptimisationOptions& local) {
  if (options.loss != RobustLoss::kNone && !IsGraduated(options.loss)) return std::nullopt;
  return LocalRun(graph, options, local).Run();
}

}  // namespace overtone
