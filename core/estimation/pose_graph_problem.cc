// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/estimation/pose_graph_problem.h"

#include <algorithm>
#include <utility>

#include "ceres/solver.h"
#include "overtone/core/estimation/connected_components.h"
#include "overtone/core/estimation/point_sighting_error.h"

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

class StepLimit final : public ceres::IterationCallback {
 public:
  explicit StepLimit(const SolveLimits& limits)
      : steps_left_(limits.max_steps), give_up_(limits.give_up) {}

  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    if (give_up_ != nullptr && *give_up_) return ceres::SOLVER_ABORT;
    if (summary.iteration > 0 && summary.step_is_successful) --steps_left_;
    return steps_left_ > 0 ? ceres::SOLVER_CONTINUE : ceres::SOLVER_TERMINATE_SUCCESSFULLY;
  }

 private:
  int steps_left_;
  const std::atomic<bool>* give_up_;
};

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

std::unique_ptr<ceres::CostFunction> MakeSightingError(const PointSighting& sighting,
                                                       const Eigen::Matrix3d& factor) {
  if (sighting.landmark >= 0) {
    return std::make_unique<LandmarkSightingError>(sighting.point_in_pose, factor);
  }
  return std::make_unique<CarriedPointSightingError>(sighting.point_in_pose,
                                                     sighting.point_in_target, factor);
}

}  // namespace

PoseGraphProblem::PoseGraphProblem(const PoseGraph& graph, const PoseGraphFactors& factors,
                                   const PoseGraphLoss& loss)
    : graph_(graph),
      num_poses_(static_cast<int>(graph.poses.size())),
      num_landmarks_(static_cast<int>(graph.landmarks.size())),
      closure_loss_(MakeLossFunction(loss.loss, loss.closure_squared_limit)),
      sighting_loss_(MakeLossFunction(loss.loss, loss.sighting_squared_limit)),
      blocks_(graph.poses.size() * kPoseBlockSize + graph.landmarks.size() * kPointBlockSize),
      held_(graph.poses.size() + graph.landmarks.size(), false),
      problem_(std::make_unique<ceres::Problem>(NonOwningOptions())) {
  SetEstimate({graph.poses, graph.landmarks});
  for (int i = 0; i < num_poses_; ++i) {
    problem_->AddParameterBlock(Block(i), kPoseBlockSize, &manifold_);
  }
  for (int i = 0; i < num_landmarks_; ++i) {
    problem_->AddParameterBlock(Block(num_poses_ + i), kPointBlockSize);
  }
  measurements_.reserve(graph.edges.size() + graph.sightings.size());
  for (size_t k = 0; k < graph.edges.size(); ++k) {
    const PoseGraphEdge& edge = graph.edges[k];
    Measurement measurement;
    measurement.error = std::make_unique<RelativePoseError>(edge.from_tform_to, factors.edges[k]);
    measurement.ends[0] = edge.from;
    measurement.ends[1] = edge.to;
    if (edge.kind == EdgeKind::kLoopClosure) {
      measurement.squared_limit = loss.closure_squared_limit;
      measurement.loss = closure_loss_.get();
    }
    Add(std::move(measurement), /*may_be_wrong=*/edge.kind == EdgeKind::kLoopClosure);
  }
  for (size_t k = 0; k < graph.sightings.size(); ++k) {
    const PointSighting& sighting = graph.sightings[k];
    Measurement measurement;
    measurement.error = MakeSightingError(sighting, factors.sightings[k]);
    measurement.ends[0] = sighting.pose;
    measurement.ends[1] =
        sighting.landmark >= 0 ? num_poses_ + sighting.landmark : sighting.target_pose;
    measurement.squared_limit = loss.sighting_squared_limit;
    measurement.loss = sighting_loss_.get();
    Add(std::move(measurement), /*may_be_wrong=*/true);
  }
}

void PoseGraphProblem::Add(Measurement measurement, bool may_be_wrong) {
  if (may_be_wrong) {
    measurement.scale = std::make_unique<ceres::LossFunctionWrapper>(
        const_cast<ceres::LossFunction*>(measurement.loss), ceres::DO_NOT_TAKE_OWNERSHIP);
  }
  problem_->AddResidualBlock(measurement.error.get(), measurement.scale.get(),
                             Block(measurement.ends[0]), Block(measurement.ends[1]));
  measurements_.push_back(std::move(measurement));
}

double* PoseGraphProblem::Block(int variable) {
  return const_cast<double*>(std::as_const(*this).Block(variable));
}

const double* PoseGraphProblem::Block(int variable) const {
  if (variable < num_poses_) return blocks_.data() + variable * kPoseBlockSize;
  return blocks_.data() + num_poses_ * kPoseBlockSize + (variable - num_poses_) * kPointBlockSize;
}

void PoseGraphProblem::HoldOnePosePerComponent() {
  const int num_variables = num_poses_ + num_landmarks_;
  ConnectedComponents components(num_variables);
  for (const Measurement& measurement : measurements_) {
    if (measurement.weight > 0) components.Unite(measurement.ends[0], measurement.ends[1]);
  }
  std::vector<bool> anchored(num_variables, false);  // of a component's first variable
  for (size_t i = 0; i < to_stay_.size(); ++i) {
    if (to_stay_[i]) anchored[components.Representative(static_cast<int>(i))] = true;
  }
  // Landmarks come after the poses, so one that is first in its component is on its own.
  for (int i = 0; i < num_variables; ++i) {
    const bool hold =
        (!to_stay_.empty() && to_stay_[i]) || (components.Representative(i) == i && !anchored[i]);
    if (hold == held_[i]) continue;
    held_[i] = hold;
    hold ? problem_->SetParameterBlockConstant(Block(i))
         : problem_->SetParameterBlockVariable(Block(i));
  }
}

int PoseGraphProblem::NumComponents() const {
  ConnectedComponents components(num_poses_ + num_landmarks_);
  for (const Measurement& measurement : measurements_) {
    components.Unite(measurement.ends[0], measurement.ends[1]);
  }
  int count = 0;
  for (int i = 0; i < num_poses_; ++i) count += components.Representative(i) == i;
  return count;
}

SolveSummary PoseGraphProblem::Solve(const SolveLimits& limits) {
  HoldOnePosePerComponent();
  StepLimit step_limit(limits);
  ceres::Solver::Options options = SolverOptions(limits);
  options.callbacks.push_back(&step_limit);
  ceres::Solver::Summary summary;
  ceres::Solve(options, problem_.get(), &summary);
  SolveSummary result;
  result.initial_cost = summary.initial_cost;
  result.final_cost = summary.final_cost;
  result.iterations = summary.num_successful_steps + summary.num_unsuccessful_steps;
  result.converged = summary.termination_type == ceres::CONVERGENCE;
  result.given_up = summary.termination_type == ceres::USER_FAILURE;
  return result;
}

void PoseGraphProblem::SetWeight(int measurement, double weight) {
  Measurement& entry = measurements_[measurement];
  entry.weight = weight;
  entry.scale->Reset(new ceres::ScaledLoss(entry.loss, weight, ceres::DO_NOT_TAKE_OWNERSHIP),
                     ceres::TAKE_OWNERSHIP);
}

double PoseGraphProblem::ChiSquare(int measurement) const {
  const Measurement& entry = measurements_[measurement];
  const double* blocks[] = {Block(entry.ends[0]), Block(entry.ends[1])};
  Vector6d residual = Vector6d::Zero();  // a sighting fills the first three
  entry.error->Evaluate(blocks, residual.data(), nullptr);
  return residual.squaredNorm();
}

double PoseGraphProblem::ChiSquareOverLimit(int measurement) const {
  return ChiSquare(measurement) / measurements_[measurement].squared_limit;
}

double PoseGraphProblem::Weight(int measurement) const {
  const Measurement& entry = measurements_[measurement];
  if (entry.loss == nullptr) return entry.weight;
  return entry.weight * InfluenceWeight(*entry.loss, ChiSquare(measurement));
}

void PoseGraphProblem::SetEstimate(const PoseGraphEstimate& estimate) {
  for (int i = 0; i < num_poses_; ++i) WritePoseBlock(estimate.poses[i], Block(i));
  for (int i = 0; i < num_landmarks_; ++i) {
    Eigen::Map<Eigen::Vector3d>{Block(num_poses_ + i)} = estimate.landmarks[i];
  }
}

void PoseGraphProblem::PlaceLandmarks() {
  std::vector<std::vector<double>> seen_at(3 * num_landmarks_);  // x, y, z of each landmark
  for (size_t k = 0; k < graph_.sightings.size(); ++k) {
    const PointSighting& sighting = graph_.sightings[k];
    if (sighting.landmark < 0 || !(measurements_[graph_.edges.size() + k].weight > 0)) continue;
    const Eigen::Vector3d point = ReadPoseBlock(Block(sighting.pose)) * sighting.point_in_pose;
    for (int axis = 0; axis < 3; ++axis) {
      seen_at[3 * sighting.landmark + axis].push_back(point(axis));
    }
  }
  for (int i = 0; i < 3 * num_landmarks_; ++i) {
    std::vector<double>& values = seen_at[i];
    if (values.empty()) continue;
    const auto middle = values.begin() + values.size() / 2;
    std::nth_element(values.begin(), middle, values.end());
    Block(num_poses_)[i] = *middle;
  }
}

PoseGraphEstimate PoseGraphProblem::Estimate() const {
  PoseGraphEstimate estimate;
  for (int i = 0; i < num_poses_; ++i) estimate.poses.push_back(ReadPoseBlock(Block(i)));
  for (int i = 0; i < num_landmarks_; ++i) {
    estimate.landmarks.push_back(Eigen::Map<const Eigen::Vector3d>(Block(num_poses_ + i)));
  }
  return estimate;
}

}  // namespace overtone
