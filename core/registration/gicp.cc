// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/registration/gicp.h"

#include <algorithm>
#include <cmath>

#include "Eigen/Cholesky"
#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/registration/surface_information.h"

namespace overtone {
namespace {

constexpr int kMinCounterparts = 3;

struct NormalEquations {
  Matrix6d hessian = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
  int num_counterparts = 0;
  double sum_of_weights = 0;

  // Of residual d, everything in the source's frame: J = [-I, p^] for a right perturbation.
  void Add(const Eigen::Vector3d& point, const Eigen::Vector3d& d,
           const Eigen::Matrix3d& pair_information, double weight) {
    const Eigen::Matrix3d information = weight * pair_information;
    const Eigen::Matrix3d information_times_skew = information * Skew(point);
    hessian.topLeftCorner<3, 3>() += information;
    hessian.topRightCorner<3, 3>() -= information_times_skew;
    hessian.bottomRightCorner<3, 3>() += Skew(point).transpose() * information_times_skew;
    gradient.head<3>() -= information * d;
    gradient.tail<3>() += information_times_skew.transpose() * d;
    ++num_counterparts;
    sum_of_weights += weight;
  }

  Vector6d Step() const { return -hessian.selfadjointView<Eigen::Upper>().ldlt().solve(gradient); }
};

// Each source point's nearest, no further than before: the last counterpart bounds the search.
void UpdateCounterparts(const RegistrationCloud& source, const RegistrationCloud& target,
                        const Rigid3d& target_from_source, float max_squared_distance,
                        std::vector<int>& target_of_source) {
  const Eigen::Matrix3f rotation = target_from_source.rotation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f translation = target_from_source.translation.cast<float>();
  for (int i = 0; i < source.size(); ++i) {
    const Eigen::Vector3f query = rotation * source.points()[i] + translation;
    int& counterpart = target_of_source[i];
    float bound = max_squared_distance;
    if (counterpart >= 0) {
      const float last = (target.points()[counterpart] - query).squaredNorm();
      if (last < bound) {
        bound = last;
      } else {
        counterpart = -1;
      }
    }
    const KdTree::Neighbor nearest = target.tree().Nearest(query, bound);
    if (nearest.index >= 0) counterpart = nearest.index;
  }
}

NormalEquations Linearise(const RegistrationCloud& source, const RegistrationCloud& target,
                          const Rigid3d& target_from_source,
                          const std::vector<int>& target_of_source, double kernel_width_m) {
  const Rigid3d source_from_target = target_from_source.Inverse();
  const Eigen::Matrix3d rotation = source_from_target.rotation.toRotationMatrix();
  const double squared_width = kernel_width_m * kernel_width_m;
  NormalEquations equations;
  for (int i = 0; i < source.size(); ++i) {
    const int j = target_of_source[i];
    if (j < 0) continue;
    const Eigen::Vector3d point = source.points()[i].cast<double>();
    const Eigen::Vector3d d =
        rotation * target.points()[j].cast<double>() + source_from_target.translation - point;
    const Eigen::Matrix3d information =
        SurfaceInformation(rotation * target.normals()[j].direction.cast<double>(),
                           source.normals()[i].direction.cast<double>());
    const double normal_squared = d.dot(information * d);
    const double root_weight = squared_width / (squared_width + normal_squared);
    equations.Add(point, d, information, root_weight * root_weight);
  }
  return equations;
}

absl::Status CheckPositive(double value, absl::string_view name) {
  if (value > 0 && std::isfinite(value)) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("GicpOptions.", name, " = ", value, ": must be positive"));
}

}  // namespace

absl::Status GicpOptions::Validate() const {
  RETURN_IF_ERROR(CheckPositive(max_correspondence_distance_m, "max_correspondence_distance_m"));
  RETURN_IF_ERROR(CheckPositive(kernel_width_m, "kernel_width_m"));
  RETURN_IF_ERROR(CheckPositive(max_iterations, "max_iterations"));
  return CheckPositive(tolerance_m, "tolerance_m");
}

GicpEstimate Gicp(const RegistrationCloud& source, const RegistrationCloud& target,
                  const Rigid3d& guess, const GicpOptions& options) {
  const float max_squared_distance = static_cast<float>(options.max_correspondence_distance_m *
                                                        options.max_correspondence_distance_m);
  GicpEstimate estimate;
  estimate.target_of_source.assign(source.size(), -1);
  estimate.target_from_source = guess;
  while (!estimate.converged && estimate.iterations < options.max_iterations) {
    UpdateCounterparts(source, target, estimate.target_from_source, max_squared_distance,
                       estimate.target_of_source);
    NormalEquations equations = Linearise(source, target, estimate.target_from_source,
                                          estimate.target_of_source, options.kernel_width_m);
    if (equations.num_counterparts < kMinCounterparts) break;
    const Vector6d step = equations.Step();
    estimate.target_from_source = estimate.target_from_source * Exp(step);
    ++estimate.iterations;
    const double squared_motion = -equations.gradient.dot(step) / equations.sum_of_weights;
    estimate.converged = squared_motion < options.tolerance_m * options.tolerance_m;
  }
  return estimate;
}

}  // namespace overtone
