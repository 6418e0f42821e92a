// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/estimation/pose_graph_optimizer.h"

#include <chrono>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/estimation/chordal_initialisation.h"
#include "overtone/core/estimation/connected_components.h"
#include "overtone/core/estimation/graduated_non_convexity.h"
#include "overtone/core/estimation/pose_graph_problem.h"
#include "overtone/core/estimation/serial_openmp.h"
#include "overtone/core/estimation/spanning_tree_initialisation.h"

namespace overtone {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kUnitLengthTolerance = 1e-6;
// Far beyond any real graph, yet their squares and products stay finite.
constexpr double kLargestTranslationM = 1e15;
constexpr double kLargestInformation = 1e30;

double SecondsSince(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

absl::Status CheckPose(const Rigid3d& pose) {
  if (!pose.rotation.coeffs().allFinite() || !pose.translation.allFinite()) {
    return absl::InvalidArgumentError("not finite");
  }
  if (std::abs(pose.rotation.norm() - 1) > kUnitLengthTolerance) {
    return absl::InvalidArgumentError("quaternion is not of unit length");
  }
  if (pose.translation.cwiseAbs().maxCoeff() > kLargestTranslationM) {
    return absl::InvalidArgumentError("translation exceeds 1e15 m");
  }
  return absl::OkStatus();
}

template <typename... Where>
absl::Status Prefix(const absl::Status& status, const Where&... where) {
  if (status.ok()) return status;
  return absl::Status(status.code(), absl::StrCat(where..., ": ", status.message()));
}

absl::Status CheckEdge(const PoseGraphEdge& edge, int num_poses) {
  if (edge.from < 0 || edge.from >= num_poses) {
    return absl::InvalidArgumentError(absl::StrCat("from = ", edge.from, " is out of range"));
  }
  if (edge.to < 0 || edge.to >= num_poses) {
    return absl::InvalidArgumentError(absl::StrCat("to = ", edge.to, " is out of range"));
  }
  if (edge.from == edge.to) return absl::InvalidArgumentError("both ends are the same pose");
  if (edge.information.cwiseAbs().maxCoeff() > kLargestInformation) {
    return absl::InvalidArgumentError("information exceeds 1e30");
  }
  return Prefix(CheckPose(edge.from_tform_to), "from_tform_to");
}

// The checks of CheckPoseGraph; the factors come out of the last one.
absl::StatusOr<std::vector<Matrix6d>> CheckAndFactorise(const PoseGraph& graph) {
  for (size_t i = 0; i < graph.poses.size(); ++i) {
    RETURN_IF_ERROR(Prefix(CheckPose(graph.poses[i]), "poses[", i, "]"));
  }
  std::vector<Matrix6d> factors;
  factors.reserve(graph.edges.size());
  for (size_t k = 0; k < graph.edges.size(); ++k) {
    RETURN_IF_ERROR(Prefix(CheckEdge(graph.edges[k], graph.poses.size()), "edges[", k, "]"));
    const auto factor = SquareRootInformation(graph.edges[k].information);
    RETURN_IF_ERROR(Prefix(factor.status(), "edges[", k, "]"));
    factors.push_back(*factor);
  }
  return factors;
}

absl::StatusOr<std::vector<Rigid3d>> Initialise(const PoseGraph& graph,
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

SolveSummary SolveProblem(const PoseGraph& graph, const PoseGraphOptimizerOptions& options,
                          PoseGraphProblem& problem) {
  SolveLimits limits;
  limits.max_iterations = options.max_iterations;
  limits.function_tolerance = options.function_tolerance;
  limits.num_threads = options.num_threads;
  if (!IsGraduated(options.loss)) return problem.Solve(limits);
  std::vector<int> closures;
  std::vector<double> weights;
  for (size_t k = 0; k < graph.edges.size(); ++k) {
    if (graph.edges[k].kind != EdgeKind::kLoopClosure) continue;
    closures.push_back(static_cast<int>(k));
    weights.push_back(options.initial_weights.empty() ? 1 : options.initial_weights[k]);
  }
  GncOptions gnc;
  gnc.loss = options.loss;
  gnc.squared_limit = options.closure_chi_square_limit;
  return SolveGraduated(closures, weights, gnc, limits, problem);
}

int CountComponents(const PoseGraph& graph) {
  ConnectedComponents components(static_cast<int>(graph.poses.size()));
  for (const PoseGraphEdge& edge : graph.edges) components.Unite(edge.from, edge.to);
  return static_cast<int>(components.Representatives().size());
}

}  // namespace

absl::Status PoseGraphOptimizerOptions::Validate() const {
  if (!(closure_chi_square_limit > 0) || !std::isfinite(closure_chi_square_limit)) {
    return absl::InvalidArgumentError("closure_chi_square_limit must be positive and finite");
  }
  if (max_iterations < 0) return absl::InvalidArgumentError("max_iterations must not be negative");
  if (!(function_tolerance >= 0)) {
    return absl::InvalidArgumentError("function_tolerance must not be negative");
  }
  if (num_threads < 1) return absl::InvalidArgumentError("num_threads must be at least 1");
  for (const double weight : initial_weights) {
    if (weight != 0 && weight != 1) {
      return absl::InvalidArgumentError("initial_weights must be 0 or 1");
    }
  }
  return absl::OkStatus();
}

absl::Status CheckPoseGraph(const PoseGraph& graph) { return CheckAndFactorise(graph).status(); }

absl::StatusOr<PoseGraphResult> OptimizePoseGraph(const PoseGraph& graph,
                                                  const PoseGraphOptimizerOptions& options) {
  const Clock::time_point begin = Clock::now();
  const SerialOpenMp serial;
  RETURN_IF_ERROR(options.Validate());
  if (!options.initial_weights.empty() && options.initial_weights.size() != graph.edges.size()) {
    return absl::InvalidArgumentError("initial_weights must be one for each edge");
  }
  ASSIGN_OR_RETURN(const std::vector<Matrix6d> factors, CheckAndFactorise(graph));
  const Clock::time_point checked = Clock::now();
  ASSIGN_OR_RETURN(const std::vector<Rigid3d> first_guess,
                   Initialise(graph, options.initialisation));
  PoseGraphResult result;
  result.initialisation_s = SecondsSince(checked);

  PoseGraphProblem problem(graph, factors, options.loss, options.closure_chi_square_limit);
  problem.SetPoses(first_guess);
  const SolveSummary summary = SolveProblem(graph, options, problem);
  result.initial_cost = summary.initial_cost;
  result.final_cost = summary.final_cost;
  result.converged = summary.converged;
  result.iterations = summary.iterations;
  result.poses = problem.Poses();
  for (size_t k = 0; k < graph.edges.size(); ++k) {
    result.weights.push_back(problem.Weight(static_cast<int>(k)));
    result.chi_squares.push_back(problem.ChiSquare(static_cast<int>(k)));
  }
  result.number_of_components = CountComponents(graph);
  result.seconds = SecondsSince(begin);
  return result;
}

}  // namespace overtone
