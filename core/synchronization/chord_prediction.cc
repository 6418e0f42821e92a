// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/synchronization/chord_prediction.h"

#include <algorithm>
#include <cmath>

#include "Eigen/Cholesky"
#include "overtone/core/synchronization/aligned_rmse.h"
#include "overtone/core/synchronization/small_motion.h"

namespace overtone {
namespace {

// Where a motion of the whole takes points.
class Placement {
 public:
  explicit Placement(const Rigid3d& motion)
      : rotation_(motion.rotation.toRotationMatrix()), translation_(motion.translation) {}
  Eigen::Vector3d operator*(const Eigen::Vector3d& point) const {
    return rotation_ * point + translation_;
  }

 private:
  Eigen::Matrix3d rotation_;  // costs a point half of what a quaternion does
  Eigen::Vector3d translation_;
};

}  // namespace

ResidualSums& ResidualSums::operator+=(const ResidualSums& other) {
  squares += other.squares;
  moment += other.moment;
  return *this;
}

ResidualSums& ResidualSums::operator-=(const ResidualSums& other) {
  squares -= other.squares;
  moment -= other.moment;
  return *this;
}

ChordPrediction::ChordPrediction(const std::vector<Rigid3d>& server,
                                 const std::vector<Rigid3d>& odometry,
                                 const std::vector<Matrix6d>& step_covariance)
    : server_(server), odometry_(odometry) {
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  for (const Rigid3d& pose : server) centroid += pose.translation / server.size();
  server_from_odometry_.reserve(server.size());
  walk_.reserve(server.size());
  positions_.reserve(server.size());
  Matrix6d walk = Matrix6d::Zero(), inertia = Matrix6d::Zero();
  for (int i = 0; i < size(); ++i) {
    server_[i].translation -= centroid;
    positions_.push_back(server_[i].translation);
    server_from_odometry_.push_back(server_[i] * odometry_[i].Inverse());
    if (i > 0) {
      const Matrix6d adjoint = Adjoint(server_[i]);
      walk.noalias() += adjoint * step_covariance[i] * adjoint.transpose();
    }
    walk_.push_back(walk);
    Eigen::Matrix<double, 3, 6> jacobian;
    jacobian << Eigen::Matrix3d::Identity(), -Skew(server_[i].translation);
    inertia.noalias() += jacobian.transpose() * jacobian;
  }
  alignment_ = inertia.ldlt().solve(Matrix6d::Identity());
}

template <typename Position>
ResidualSums ChordPrediction::Sum(int begin, int end, int max_samples,
                                  const Position& position) const {
  ResidualSums sums;
  const int count = end - begin;
  if (count <= 0) return sums;
  const int samples = max_samples > 0 ? std::min(count, max_samples) : count;
  for (int k = 0; k < samples; ++k) {
    // The middles of equal shares.
    const int i =
        begin + static_cast<int>((2 * static_cast<int64_t>(k) + 1) * count / (2 * samples));
    const Eigen::Vector3d& server = positions_[i];
    const Eigen::Vector3d residual = position(i) - server;
    sums.squares += residual.squaredNorm();
    sums.moment.head<3>() += residual;
    sums.moment.tail<3>() += server.cross(residual);
  }
  const double weight = static_cast<double>(count) / samples;
  sums.squares *= weight;
  sums.moment *= weight;
  return sums;
}

Vector6d ChordPrediction::Gap(int from, int to) const {
  return Log(server_from_odometry_[to] * server_from_odometry_[from].Inverse());
}

Vector6d ChordPrediction::Spread(int from, int to) const {
  const Matrix6d covariance = walk_[to] - walk_[from];
  const Eigen::LLT<Matrix6d> root(covariance);
  if (root.info() == Eigen::Success) return root.solve(Gap(from, to));
  return covariance.ldlt().solve(Gap(from, to));  // round-off
}

double ChordPrediction::GapChiSquare(int from, int to) const {
  return Gap(from, to).dot(Spread(from, to));
}

ResidualSums ChordPrediction::Between(int from, int to, int max_samples) const {
  if (to - from < 2) return ResidualSums();
  const Vector6d spread = Spread(from, to);
  const Vector6d begin = walk_[from] * spread;
  const Placement placement(server_from_odometry_[from]);
  return Sum(from + 1, to, max_samples, [&](int i) {
    const Vector6d moved = walk_[i] * spread - begin;
    return MovedBy(moved, placement * odometry_[i].translation);
  });
}

ResidualSums ChordPrediction::Before(int knot, int max_samples) const {
  const Placement placement(server_from_odometry_[knot]);
  return Sum(0, knot, max_samples, [&](int i) { return placement * odometry_[i].translation; });
}

ResidualSums ChordPrediction::Behind(int knot, int max_samples) const {
  const Placement placement(server_from_odometry_[knot]);
  return Sum(knot + 1, size(), max_samples,
             [&](int i) { return placement * odometry_[i].translation; });
}

ResidualSums ChordPrediction::Of(const std::vector<int>& knots, int max_samples) const {
  ResidualSums sums = Before(knots.front(), max_samples);
  for (int k = 1; k < knots.size(); ++k) sums += Between(knots[k - 1], knots[k], max_samples);
  return sums += Behind(knots.back(), max_samples);
}

double ChordPrediction::Rmse(const ResidualSums& sums) const {
  const double left = sums.squares - sums.moment.dot(Alignment(sums));
  return std::sqrt(std::max(left, 0.0) / size());
}

std::vector<Rigid3d> ChordPrediction::Predict(const std::vector<int>& knots) const {
  std::vector<Rigid3d> poses;
  poses.reserve(server_.size());
  const int first = knots.empty() ? 0 : knots.front();
  for (int i = 0; i <= first; ++i) poses.push_back(server_from_odometry_[first] * odometry_[i]);
  for (int k = 1; k < knots.size(); ++k) {
    const int from = knots[k - 1];
    const Vector6d spread = Spread(from, knots[k]);
    for (int i = from + 1; i <= knots[k]; ++i) {
      const Vector6d moved = (walk_[i] - walk_[from]) * spread;
      poses.push_back(Exp(moved) * (server_from_odometry_[from] * odometry_[i]));
    }
  }
  const int last = knots.empty() ? 0 : knots.back();
  for (int i = last + 1; i < size(); ++i) {
    poses.push_back(server_from_odometry_[last] * odometry_[i]);
  }
  return poses;
}

std::vector<Eigen::Vector3d> ChordPrediction::PredictPositions(
    const std::vector<int>& knots) const {
  std::vector<Eigen::Vector3d> positions;
  positions.reserve(positions_.size());
  const auto add_unchanged = [&](int knot, int begin, int end) {
    const Placement placement(server_from_odometry_[knot]);
    for (int i = begin; i < end; ++i) positions.push_back(placement * odometry_[i].translation);
  };
  if (knots.empty()) {
    add_unchanged(0, 0, size());
    return positions;
  }
  add_unchanged(knots.front(), 0, knots.front() + 1);
  for (int k = 1; k < knots.size(); ++k) {
    const int from = knots[k - 1];
    const Vector6d spread = Spread(from, knots[k]);
    const Vector6d begin = walk_[from] * spread;
    const Placement placement(server_from_odometry_[from]);
    for (int i = from + 1; i <= knots[k]; ++i) {
      const Vector6d moved = walk_[i] * spread - begin;
      positions.push_back(MovedBy(moved, placement * odometry_[i].translation));
    }
  }
  add_unchanged(knots.back(), knots.back() + 1, size());
  return positions;
}

double ChordPrediction::ExactRmse(const std::vector<int>& knots) const {
  return AlignedRmse(PredictPositions(knots), positions_);
}

Matrix6d ChordPrediction::Covariance(int from, int to) const {
  const Matrix6d adjoint = Adjoint(server_[to].Inverse());
  const Matrix6d covariance = adjoint * (walk_[to] - walk_[from]) * adjoint.transpose();
  return 0.5 * (covariance + covariance.transpose());
}

}  // namespace overtone
