// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/place_recognition/scan_context.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "absl/strings/str_cat.h"

namespace overtone {
namespace {

constexpr double kTwoPi = 2 * M_PI;
// The ground is at the height that so few points lie below: reflections and pits.
constexpr double kGroundQuantile = 0.03;
// What a point on the ground counts, beside the metres above it: seen matters as well as tall.
constexpr float kGroundValue = 1;
// Half of a cell's value leaks into the rings beside it: a wall at a cell's border is in both.
constexpr float kLeak = 0.5;
// Sectors that halve the trust in a mean over as many: few columns are alike by chance.
constexpr double kDoubtSectors = 6;
// Whoever saw less than this cannot be sure even of itself.
constexpr double kSureAngle = kTwoPi / 6;

double GroundHeight(std::vector<Eigen::Vector3f>& points) {
  const auto ground = points.begin() + static_cast<int64_t>(kGroundQuantile * (points.size() - 1));
  std::nth_element(points.begin(), ground, points.end(),
                   [](const auto& a, const auto& b) { return a.z() < b.z(); });
  return ground->z();
}

// Upright, in range, x y z.
std::vector<Eigen::Vector3f> PointsInRange(const PointCloud& cloud,
                                           const Eigen::Quaterniond& level_from_body,
                                           const ScanContextOptions& options) {
  const Eigen::Matrix3f rotation = level_from_body.toRotationMatrix().cast<float>();
  std::vector<Eigen::Vector3f> points;
  points.reserve(cloud.size());
  for (const Eigen::Vector3f& point_in_body : cloud.points) {
    const Eigen::Vector3f point = rotation * point_in_body;
    const float range = point.head<2>().norm();
    if (range >= options.min_range_m && range < options.max_range_m) points.push_back(point);
  }
  return points;
}

Eigen::MatrixXf HighestPoints(std::vector<Eigen::Vector3f> points,
                              const ScanContextOptions& options) {
  Eigen::MatrixXf highest = Eigen::MatrixXf::Zero(options.rings, options.sectors);
  if (points.empty()) return highest;
  const double ground = GroundHeight(points);
  const double rings_per_log = options.rings / std::log(options.max_range_m / options.min_range_m);
  for (const Eigen::Vector3f& point : points) {
    const double range = point.head<2>().norm();
    const int ring = static_cast<int>(rings_per_log * std::log(range / options.min_range_m));
    const double turns = (std::atan2(point.y(), point.x()) + M_PI) / kTwoPi;
    const int sector = static_cast<int>(turns * options.sectors) % options.sectors;
    float& cell = highest(std::clamp(ring, 0, options.rings - 1), sector);
    cell = std::max(cell, kGroundValue + std::max(0.f, static_cast<float>(point.z() - ground)));
  }
  return highest;
}

double Evidence(double sectors) { return sectors / (sectors + kDoubtSectors); }

// Sum over all entries of a * b, a's columns taken s further on (around the end), for each s. With
// a written down twice, what a shift takes is one stretch of memory: a column of a matrix that
// overlaps itself.
Eigen::VectorXf DotAtEachShift(const Eigen::MatrixXf& a, const Eigen::MatrixXf& b) {
  const Eigen::MatrixXf twice = a.replicate(1, 2);
  const Eigen::Map<const Eigen::MatrixXf, 0, Eigen::OuterStride<>> shifted(
      twice.data(), a.size(), a.cols(), Eigen::OuterStride<>(a.rows()));
  return shifted.transpose() * b.reshaped();
}

// Of a parabola through (-1, before), (0, best), (1, after): where it is highest.
double Peak(double before, double best, double after) {
  const double curvature = before - 2 * best + after;
  return curvature < 0 ? 0.5 * (before - after) / curvature : 0;
}

}  // namespace

absl::Status ScanContextOptions::Validate() const {
  if (!(min_range_m > 0 && std::isfinite(min_range_m))) {
    return absl::InvalidArgumentError("min_range_m must be positive and finite");
  }
  if (!(max_range_m > min_range_m && std::isfinite(max_range_m))) {
    return absl::InvalidArgumentError("max_range_m must be above min_range_m and finite");
  }
  if (rings < 2 || rings > 1000 || rings % 2 != 0) {
    return absl::InvalidArgumentError(absl::StrCat("rings: ", rings, " is not even in [2, 1000]"));
  }
  if (sectors < 4 || sectors > 1000) {
    return absl::InvalidArgumentError(absl::StrCat("sectors: ", sectors, " is not in [4, 1000]"));
  }
  if (!(min_common_share >= 0 && min_common_share <= 1)) {
    return absl::InvalidArgumentError("min_common_share is not in [0, 1]");
  }
  return absl::OkStatus();
}

Eigen::Quaterniond LevelFromBody(const Eigen::Quaterniond& mission_from_body) {
  const Eigen::Vector3d ahead = mission_from_body * Eigen::Vector3d::UnitX();
  const double heading = std::atan2(ahead.y(), ahead.x());
  return Eigen::AngleAxisd(-heading, Eigen::Vector3d::UnitZ()) * mission_from_body;
}

Eigen::Quaterniond BodyRotation(const Eigen::Quaterniond& level_from_from, double yaw_rad,
                                const Eigen::Quaterniond& level_from_to) {
  return level_from_from.conjugate() * Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()) *
         level_from_to;
}

ScanContext ComputeScanContext(const PointCloud& cloud, const Eigen::Quaterniond& level_from_body,
                               const ScanContextOptions& options) {
  const Eigen::MatrixXf highest =
      HighestPoints(PointsInRange(cloud, level_from_body, options), options);
  ScanContext context;
  context.columns = highest;
  context.columns.topRows(options.rings - 1) += kLeak * highest.bottomRows(options.rings - 1);
  context.columns.bottomRows(options.rings - 1) += kLeak * highest.topRows(options.rings - 1);
  const Eigen::RowVectorXf lengths = context.columns.colwise().norm();  // 0, or 1 and more
  context.columns.array().rowwise() /= lengths.array().max(1);
  context.seen = (highest.colwise().maxCoeff().array() > 0).cast<float>().transpose();
  const Eigen::VectorXf rings = context.columns.rowwise().sum() / std::max(1.f, context.seen.sum());
  context.ring_key = rings.reshaped(2, options.rings / 2).colwise().sum().transpose();
  return context;
}

ScanContextMatch CompareScanContexts(const ScanContext& from, const ScanContext& to,
                                     const ScanContextOptions& options) {
  const Eigen::Index sectors = to.columns.cols();
  const Eigen::VectorXf cosines = DotAtEachShift(from.columns, to.columns);
  const Eigen::VectorXf common = DotAtEachShift(from.seen.transpose(), to.seen.transpose());
  const double least_seen = std::min(from.seen.sum(), to.seen.sum());
  const double sure = Evidence(std::max(least_seen, sectors * kSureAngle / kTwoPi));
  Eigen::VectorXd similarities = Eigen::VectorXd::Zero(sectors);
  for (Eigen::Index shift = 0; shift < sectors; ++shift) {
    if (common[shift] == 0 || common[shift] < options.min_common_share * least_seen) continue;
    similarities[shift] = cosines[shift] / common[shift] * Evidence(common[shift]) / sure;
  }
  Eigen::Index best;
  ScanContextMatch match;
  match.similarity = std::min(1.0, similarities.maxCoeff(&best));
  if (match.similarity == 0) return match;
  const double before = similarities[(best + sectors - 1) % sectors];
  const double after = similarities[(best + 1) % sectors];
  const double fraction = before > 0 && after > 0 ? Peak(before, similarities[best], after) : 0;
  match.yaw_rad = std::remainder((best + fraction) * kTwoPi / sectors, kTwoPi);
  return match;
}

}  // namespace overtone
