// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/registration/registration_covariance.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "Eigen/Eigenvalues"
#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {
namespace {

// Keeps the rotation about a line of points finite.
constexpr double kLeastLever_m = 0.01;

// A pair in the source's frame.
struct SurfacePair {
  Eigen::Vector3d point;
  Eigen::Vector3d normal;  // the mean of both
  double residual_m;       // along it
  double measurements;     // that it stands for, [0, 1]
};

std::vector<SurfacePair> SurfacePairs(const RegistrationCloud& source,
                                      const RegistrationCloud& target,
                                      const Rigid3d& target_from_source,
                                      const std::vector<int>& target_of_source,
                                      double max_distance_m) {
  const Rigid3d source_from_target = target_from_source.Inverse();
  std::vector<SurfacePair> pairs;
  for (int i = 0; i < source.size(); ++i) {
    const int j = target_of_source[i];
    if (j < 0) continue;
    const Eigen::Vector3d point = source.points()[i].cast<double>();
    const Eigen::Vector3d d = source_from_target * target.points()[j].cast<double>() - point;
    if (d.norm() > max_distance_m) continue;
    const Eigen::Vector3d n = source.normals()[i].direction.cast<double>();
    Eigen::Vector3d m = source_from_target.rotation * target.normals()[j].direction.cast<double>();
    if (n.dot(m) < 0) m = -m;
    const Eigen::Vector3d mean = (n + m).normalized();
    // cos(2 angle): pairs whose normals are 45 degrees apart are not of one surface.
    const double agreement = std::max(0.0, 2 * n.dot(m) * n.dot(m) - 1);
    const double certainty = source.normals()[i].certainty * target.normals()[j].certainty;
    pairs.push_back({point, mean, mean.dot(d), agreement * certainty * source.independence()[i]});
  }
  return pairs;
}

// Where the measurements are and how rotations about their centre move them: by |lever * phi|
// (rms).
struct Extent {
  double measurements = 0;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Eigen::Matrix3d lever = Eigen::Matrix3d::Zero();  // metres; symmetric positive definite
};

Extent ExtentOf(const std::vector<SurfacePair>& pairs) {
  Extent extent;
  for (const SurfacePair& pair : pairs) {
    extent.measurements += pair.measurements;
    extent.centre += pair.measurements * pair.point;
  }
  extent.centre /= extent.measurements;
  Eigen::Matrix3d squared_lever = kLeastLever_m * kLeastLever_m * Eigen::Matrix3d::Identity();
  for (const SurfacePair& pair : pairs) {
    const Eigen::Matrix3d arm = Skew(pair.point - extent.centre);
    squared_lever += pair.measurements / extent.measurements * arm.transpose() * arm;
  }
  extent.lever = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(squared_lever).operatorSqrt();
  return extent;
}

// In the tangent [rho; lever * phi] at the centre: every entry is a number of measurements.
Matrix6d Information(const std::vector<SurfacePair>& pairs, const Extent& extent) {
  const Eigen::Matrix3d inverse_lever = extent.lever.inverse();
  Matrix6d information = Matrix6d::Zero();
  for (const SurfacePair& pair : pairs) {
    const Eigen::Vector3d arm = pair.point - extent.centre;
    Vector6d jacobian;
    jacobian << pair.normal, inverse_lever * arm.cross(pair.normal);
    information += pair.measurements * jacobian * jacobian.transpose();
  }
  return information;
}

double ResidualRms(const std::vector<SurfacePair>& pairs) {
  double squares = 0;
  for (const SurfacePair& pair : pairs) squares += pair.residual_m * pair.residual_m;
  return std::sqrt(squares / static_cast<double>(pairs.size()));
}

// The inverse of `information`, with `open_variance` along eigenvectors that have less than
// `least`.
struct Inverse {
  Eigen::MatrixXd covariance;
  int open_directions = 0;
};

Inverse Invert(const Eigen::MatrixXd& information, double variance, double least,
               double open_variance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(information);
  Inverse inverse;
  Eigen::VectorXd variances(information.rows());
  for (int k = 0; k < variances.size(); ++k) {
    const bool open = !(eigen.eigenvalues()(k) > least);
    variances(k) = open ? open_variance : variance / eigen.eigenvalues()(k);
    inverse.open_directions += open;
  }
  const Eigen::MatrixXd& vectors = eigen.eigenvectors();
  inverse.covariance = vectors * variances.asDiagonal() * vectors.transpose();
  return inverse;
}

// From the tangent at the centre to that of the body frame: rho = rho_c + c x phi.
Matrix6d BodyFromCentre(const Extent& extent) {
  Matrix6d body_from_centre = Matrix6d::Identity();
  const Eigen::Matrix3d inverse_lever = extent.lever.inverse();
  body_from_centre.topRightCorner<3, 3>() = Skew(extent.centre) * inverse_lever;
  body_from_centre.bottomRightCorner<3, 3>() = inverse_lever;
  return body_from_centre;
}

Vector6d Squares(double translation, double rotation) {
  Vector6d squares;
  squares << Eigen::Vector3d::Constant(translation * translation),
      Eigen::Vector3d::Constant(rotation * rotation);
  return squares;
}

absl::Status CheckPositive(double value, absl::string_view name) {
  if (value > 0 && std::isfinite(value)) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("CovarianceOptions.", name, " = ", value, ": must be positive"));
}

}  // namespace

absl::Status CovarianceOptions::Validate() const {
  RETURN_IF_ERROR(CheckPositive(min_share, "min_share"));
  RETURN_IF_ERROR(CheckPositive(systematic_m, "systematic_m"));
  RETURN_IF_ERROR(CheckPositive(systematic_rad, "systematic_rad"));
  RETURN_IF_ERROR(CheckPositive(open_m, "open_m"));
  RETURN_IF_ERROR(CheckPositive(held_m, "held_m"));
  return CheckPositive(held_rad, "held_rad");
}

RegistrationCovariance EstimateCovariance(const RegistrationCloud& source,
                                          const RegistrationCloud& target,
                                          const Rigid3d& target_from_source,
                                          const std::vector<int>& target_of_source,
                                          double max_distance_m, const CovarianceOptions& options) {
  const bool planar = source.planar() && target.planar();
  const std::vector<int> free =
      planar ? std::vector<int>{0, 1, 5} : std::vector<int>{0, 1, 2, 3, 4, 5};
  const std::vector<int> held = planar ? std::vector<int>{2, 3, 4} : std::vector<int>{};
  RegistrationCovariance result;
  result.open_directions = static_cast<int>(free.size());
  result.covariance.diagonal() = Squares(options.open_m, M_PI);
  const std::vector<SurfacePair> pairs =
      SurfacePairs(source, target, target_from_source, target_of_source, max_distance_m);
  // Pairs may be there and speak for nothing: lone points, whose normals are a guess.
  const bool measured = std::any_of(pairs.begin(), pairs.end(),
                                    [](const SurfacePair& pair) { return pair.measurements > 0; });
  if (measured) {
    const Extent extent = ExtentOf(pairs);
    result.residual_m = ResidualRms(pairs);
    const Inverse inverse =
        Invert(Information(pairs, extent)(free, free), result.residual_m * result.residual_m,
               options.min_share * extent.measurements, options.open_m * options.open_m);
    result.open_directions = inverse.open_directions;
    Matrix6d at_centre = Matrix6d::Zero();
    at_centre(free, free) = inverse.covariance;
    const Matrix6d body_from_centre = BodyFromCentre(extent);
    result.covariance = body_from_centre * at_centre * body_from_centre.transpose();
    result.covariance.diagonal() += Squares(options.systematic_m, options.systematic_rad);
  }
  const Vector6d held_variances = Squares(options.held_m, options.held_rad);
  for (const int k : held) {
    result.covariance.row(k).setZero();
    result.covariance.col(k).setZero();
    result.covariance(k, k) = held_variances(k);
  }
  return result;
}

}  // namespace overtone
