// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <random>

#include "Eigen/Eigenvalues"
#include "overtone/core/geometry/rigid_alignment.h"
#include "overtone/core/mapping/frame_joining.h"

namespace overtone {
namespace {

constexpr size_t kMaxPoints = 1000;  // of more, an even sample
constexpr int kSamples = 500;
constexpr int kMinAgreeing = 3;
constexpr int kRefinements = 3;
// Lever arm of the agreeing points over their tolerance, below which the rotation is a guess.
constexpr double kMinExtentInTolerances = 2;
// How many more must agree before a frame counts as tilted.
constexpr double kTiltFactor = 1.3;

using Points = std::vector<PointTie>;

std::optional<Rigid3d> Fit(const Points& points, AlignmentMode mode) {
  std::vector<Eigen::Vector3d> older, younger;
  for (const PointTie& point : points) {
    older.push_back(point.point_in_older);
    younger.push_back(point.point_in_younger);
  }
  const auto alignment = UmeyamaAlignment(younger, older, mode);
  if (!alignment.ok()) return std::nullopt;
  return *alignment;
}

Points Agreeing(const Points& points, const Rigid3d& older_from_younger) {
  Points agreeing;
  for (const PointTie& point : points) {
    const Eigen::Vector3d error =
        older_from_younger * point.point_in_younger - point.point_in_older;
    if (error.norm() <= point.tolerance_m) agreeing.push_back(point);
  }
  return agreeing;
}

// The lever arm of the rotation that the points tell least, in mean tolerances: their root mean
// square distance from the vertical through their centroid or, for any rotation, from the line that
// comes nearest to them all.
double Extent(const Points& points, AlignmentMode mode) {
  const double n = static_cast<double>(points.size());
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  double tolerance = 0;
  for (const PointTie& point : points) {
    centroid += point.point_in_older / n;
    tolerance += point.tolerance_m / n;
  }
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const PointTie& point : points) {
    const Eigen::Vector3d offset = point.point_in_older - centroid;
    scatter += offset * offset.transpose() / n;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(scatter, Eigen::EigenvaluesOnly);
  const double along =
      mode == AlignmentMode::kYawOnly ? scatter(2, 2) : eigen.eigenvalues().maxCoeff();
  return std::sqrt(std::max(0.0, scatter.trace() - along)) / tolerance;
}

std::optional<FrameAlignment> BestBySamples(const Points& points, AlignmentMode mode) {
  const int sample_size = mode == AlignmentMode::kYawOnly ? 2 : 3;
  std::mt19937 random(1);  // its numbers are the same everywhere
  FrameAlignment best;
  for (int k = 0; k < kSamples; ++k) {
    Points sample;
    for (int i = 0; i < sample_size; ++i) sample.push_back(points[random() % points.size()]);
    std::optional<Rigid3d> alignment = Fit(sample, mode);
    Points agreeing;
    for (int i = 0; i <= kRefinements && alignment.has_value(); ++i) {
      agreeing = Agreeing(points, *alignment);
      // Worth refining only when it may win.
      if (static_cast<int>(agreeing.size()) < std::max(kMinAgreeing, best.points)) break;
      if (i == kRefinements) break;
      const std::optional<Rigid3d> refined = Fit(agreeing, mode);
      if (!refined.has_value()) break;
      alignment = refined;
    }
    const int count = static_cast<int>(agreeing.size());
    if (count < kMinAgreeing || count <= best.points) continue;
    if (Extent(agreeing, mode) < kMinExtentInTolerances) continue;
    best.older_from_younger = *alignment;
    best.points = count;
  }
  if (best.points == 0) return std::nullopt;
  return best;
}

}  // namespace

std::optional<FrameAlignment> AlignPoints(const std::vector<PointTie>& all) {
  Points points;
  const size_t stride = std::max<size_t>(1, (all.size() + kMaxPoints - 1) / kMaxPoints);
  for (size_t k = 0; k < all.size(); k += stride) points.push_back(all[k]);
  if (points.size() < kMinAgreeing) return std::nullopt;
  std::optional<FrameAlignment> best = BestBySamples(points, AlignmentMode::kYawOnly);
  // Nothing to gain by tilting when nearly all agree already.
  const int level = best.has_value() ? best->points : 0;
  if (kTiltFactor * level >= static_cast<double>(points.size())) return best;
  const std::optional<FrameAlignment> tilted = BestBySamples(points, AlignmentMode::kSe3);
  if (tilted.has_value() && tilted->points > kTiltFactor * level) best = tilted;
  return best;
}

}  // namespace overtone
