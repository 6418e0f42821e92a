// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/estimation/pose_graph_optimizer.h"

#include <chrono>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/estimation/chordal_initialisation.h"
#include "overtone/core/estimation/graduated_non_convexity.h"
#include "overtone/core/estimation/pose_graph_problem.h"
#include "overtone/core/estimation/serial_openmp.h"
#include "overtone/core/estimation/spanning_tree_initialisation.h"

namespace overtone {
namespace {

using Clock = std::chrono::steady_clock;

double SecondsSince(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

absl::StatusOr<std::vector<Rigid3d>> InitialPoses(const PoseGraph& graph,
                                                  PoseGraphInitialisation initialisation) {
  switch (initialisation) {
    case PoseGraphInitialisation::kSpanningTree:
      return SpanningTreeInitialisation(graph);
    case PoseGraphInitialisation::kChordal:
      return ChordalInitialisation(graph);
    case PoseGraphInitialisation::kGiven:
      break;
  }
  return graph.poses;
}

// One for each measurement, edges first.
std::vector<double> InitialWeights(const PoseGraph& graph,
                                   const PoseGraphOptimizerOptions& options) {
  std::vector<double> weights = options.initial_weights;
  weights.resize(graph.edges.size(), 1);
  weights.insert(weights.end(), options.initial_sighting_weights.begin(),
                 options.initial_sighting_weights.end());
  weights.resize(graph.edges.size() + graph.sightings.size(), 1);
  return weights;
}

SolveSummary SolveProblem(const PoseGraph& graph, const PoseGraphOptimizerOptions& options,
                          PoseGraphProblem& problem) {
  SolveLimits limits;
  limits.max_iterations = options.max_iterations;
  limits.function_tolerance = options.function_tolerance;
  limits.num_threads = options.num_threads;
  limits.give_up = options.give_up;
  if (!IsGraduated(options.loss)) return problem.Solve(limits);
  const std::vector<double> all_weights = InitialWeights(graph, options);
  std::vector<int> doubtful;
  std::vector<double> weights;
  for (int k = 0; k < problem.NumMeasurements(); ++k) {
    if (!problem.MayBeWrong(k)) continue;
    doubtful.push_back(k);
    weights.push_back(all_weights[k]);
  }
  GncOptions gnc;
  gnc.loss = options.loss;
  return SolveGraduated(doubtful, weights, gnc, limits, problem);
}

absl::Status CheckWeights(const char* name, const std::vector<double>& weights) {
  for (const double weight : weights) {
    if (weight != 0 && weight != 1) {
      return absl::InvalidArgumentError(absl::StrCat(name, " must be 0 or 1"));
    }
  }
  return absl::OkStatus();
}

absl::Status CheckLimit(const char* name, double limit) {
  if (limit > 0 && std::isfinite(limit)) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(name, " must be positive and finite"));
}

}  // namespace

absl::Status PoseGraphOptimizerOptions::Validate() const {
  RETURN_IF_ERROR(CheckLimit("closure_chi_square_limit", closure_chi_square_limit));
  RETURN_IF_ERROR(CheckLimit("sighting_chi_square_limit", sighting_chi_square_limit));
  if (max_iterations < 0) return absl::InvalidArgumentError("max_iterations must not be negative");
  if (!(function_tolerance >= 0)) {
    return absl::InvalidArgumentError("function_tolerance must not be negative");
  }
  if (num_threads < 1) return absl::InvalidArgumentError("num_threads must be at least 1");
  RETURN_IF_ERROR(CheckWeights("initial_weights", initial_weights));
  return CheckWeights("initial_sighting_weights", initial_sighting_weights);
}

absl::StatusOr<PoseGraphResult> OptimizePoseGraph(const PoseGraph& graph,
                                                  const PoseGraphOptimizerOptions& options) {
  const Clock::time_point begin = Clock::now();
  const SerialOpenMp serial;
  RETURN_IF_ERROR(options.Validate());
  if (!options.initial_weights.empty() && options.initial_weights.size() != graph.edges.size()) {
    return absl::InvalidArgumentError("initial_weights must be one for each edge");
  }
  if (!options.initial_sighting_weights.empty() &&
      options.initial_sighting_weights.size() != graph.sightings.size()) {
    return absl::InvalidArgumentError("initial_sighting_weights must be one for each sighting");
  }
  if (!options.held.empty() && options.held.size() != graph.poses.size() + graph.landmarks.size()) {
    return absl::InvalidArgumentError("held must be one for each pose and landmark");
  }
  ASSIGN_OR_RETURN(const PoseGraphFactors factors, CheckAndFactorise(graph));
  const Clock::time_point checked = Clock::now();
  ASSIGN_OR_RETURN(const std::vector<Rigid3d> first_guess,
                   InitialPoses(graph, options.initialisation));
  PoseGraphResult result;
  result.initialisation_s = SecondsSince(checked);

  PoseGraphProblem problem(
      graph, factors,
      {options.loss, options.closure_chi_square_limit, options.sighting_chi_square_limit});
  problem.Hold(options.held);
  problem.SetEstimate({first_guess, graph.landmarks});
  if (options.initialisation != PoseGraphInitialisation::kGiven) problem.PlaceLandmarks();
  const SolveSummary summary = SolveProblem(graph, options, problem);
  if (summary.given_up) return absl::CancelledError("given up");
  result.initial_cost = summary.initial_cost;
  result.final_cost = summary.final_cost;
  result.converged = summary.converged;
  result.iterations = summary.iterations;
  PoseGraphEstimate estimate = problem.Estimate();
  result.poses = std::move(estimate.poses);
  result.landmarks = std::move(estimate.landmarks);
  const int num_edges = static_cast<int>(graph.edges.size());
  for (int k = 0; k < problem.NumMeasurements(); ++k) {
    (k < num_edges ? result.weights : result.sighting_weights).push_back(problem.Weight(k));
    (k < num_edges ? result.chi_squares : result.sighting_chi_squares)
        .push_back(problem.ChiSquare(k));
  }
  result.number_of_components = problem.NumComponents();
  result.seconds = SecondsSince(begin);
  return result;
}

}  // namespace overtone
