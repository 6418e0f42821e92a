// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/estimation/pose_graph_problem.h"

#include "ceres/solver.h"
#include "overtone/core/estimation/connected_components.h"

namespace overtone {
namespace {

ceres::Problem::Options NonOwningOptions() {
  ceres::Problem::Options options;
  options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.disable_all_safety_checks = true;  // CheckPoseGraph has made them
  return options;
}

ceres::Solver::Options SolverOptions(const SolveLimits& limits) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
  options.logging_type = ceres::SILENT;
  options.max_num_iterations = limits.max_iterations;
  options.num_threads = limits.num_threads;
  options.function_tolerance = limits.function_tolerance;
  options.gradient_tolerance = 1e-12;
  options.parameter_tolerance = 1e-14;
  // Initial guesses are good: start at Gauss-Newton. 1e8 still slows down graphs with weak modes.
  options.initial_trust_region_radius = 1e12;
  return options;
}

}  // namespace

PoseGraphProblem::PoseGraphProblem(const PoseGraph& graph,
                                   const std::vector<Matrix6d>& square_root_information,
                                   RobustLoss loss, double squared_limit)
    : graph_(graph),
      loss_(MakeLossFunction(loss, squared_limit)),
      blocks_(graph.poses.size() * kPoseBlockSize),
      weights_(graph.edges.size(), 1.0),
      held_(graph.poses.size(), false),
      scales_(graph.edges.size()),
      problem_(std::make_unique<ceres::Problem>(NonOwningOptions())) {
  SetPoses(graph.poses);
  for (size_t i = 0; i < graph.poses.size(); ++i) {
    problem_->AddParameterBlock(&blocks_[i * kPoseBlockSize], kPoseBlockSize, &manifold_);
  }
  for (size_t k = 0; k < graph.edges.size(); ++k) {
    const PoseGraphEdge& edge = graph.edges[k];
    errors_.emplace_back(edge.from_tform_to, square_root_information[k]);
    if (edge.kind == EdgeKind::kLoopClosure) {
      scales_[k] =
          std::make_unique<ceres::LossFunctionWrapper>(loss_.get(), ceres::DO_NOT_TAKE_OWNERSHIP);
    }
    problem_->AddResidualBlock(&errors_[k], scales_[k].get(), &blocks_[edge.from * kPoseBlockSize],
                               &blocks_[edge.to * kPoseBlockSize]);
  }
}

void PoseGraphProblem::HoldOnePosePerComponent() {
  ConnectedComponents components(static_cast<int>(graph_.poses.size()));
  for (size_t k = 0; k < graph_.edges.size(); ++k) {
    if (weights_[k] > 0) components.Unite(graph_.edges[k].from, graph_.edges[k].to);
  }
  for (size_t i = 0; i < graph_.poses.size(); ++i) {
    const bool hold = components.Representative(i) == static_cast<int>(i);
    if (hold == held_[i]) continue;
    held_[i] = hold;
    double* block = &blocks_[i * kPoseBlockSize];
    hold ? problem_->SetParameterBlockConstant(block) : problem_->SetParameterBlockVariable(block);
  }
}

SolveSummary PoseGraphProblem::Solve(const SolveLimits& limits) {
  HoldOnePosePerComponent();
  ceres::Solver::Summary summary;
  ceres::Solve(SolverOptions(limits), problem_.get(), &summary);
  SolveSummary result;
  result.initial_cost = summary.initial_cost;
  result.final_cost = summary.final_cost;
  result.iterations = summary.num_successful_steps + summary.num_unsuccessful_steps;
  result.converged = summary.termination_type == ceres::CONVERGENCE;
  return result;
}

void PoseGraphProblem::SetWeight(int edge, double weight) {
  weights_[edge] = weight;
  scales_[edge]->Reset(new ceres::ScaledLoss(loss_.get(), weight, ceres::DO_NOT_TAKE_OWNERSHIP),
                       ceres::TAKE_OWNERSHIP);
}

double PoseGraphProblem::ChiSquare(int edge) const {
  const PoseGraphEdge& ends = graph_.edges[edge];
  return errors_[edge].ChiSquare(ReadPoseBlock(&blocks_[ends.from * kPoseBlockSize]),
                                 ReadPoseBlock(&blocks_[ends.to * kPoseBlockSize]));
}

double PoseGraphProblem::Weight(int edge) const {
  if (scales_[edge] == nullptr || loss_ == nullptr) return weights_[edge];
  return weights_[edge] * InfluenceWeight(*loss_, ChiSquare(edge));
}

void PoseGraphProblem::SetPoses(const std::vector<Rigid3d>& poses) {
  for (size_t i = 0; i < poses.size(); ++i) {
    WritePoseBlock(poses[i], &blocks_[i * kPoseBlockSize]);
  }
}

std::vector<Rigid3d> PoseGraphProblem::Poses() const {
  std::vector<Rigid3d> poses(graph_.poses.size());
  for (size_t i = 0; i < poses.size(); ++i) poses[i] = ReadPoseBlock(&blocks_[i * kPoseBlockSize]);
  return poses;
}

}  // namespace overtone
