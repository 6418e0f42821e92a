// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/synchronization/discrepancy_filter.h"

#include <algorithm>
#include <utility>

#include "overtone/core/common/status_macros.h"
#include "overtone/core/geometry/rigid_alignment.h"
#include "overtone/core/spectral/fast_filter.h"
#include "overtone/core/spectral/radius_graph.h"
#include "overtone/core/synchronization/wavelet_discrepancy.h"

namespace overtone {
namespace {

// Several changes in a row may err by this many tolerances together.
constexpr double kErrorsTogether = 2;
// A change filtered more coarsely than this is filtered no faster.
constexpr double kCoarsest = 0.05;

std::vector<Eigen::Vector3d> Positions(const std::vector<Rigid3d>& poses) {
  std::vector<Eigen::Vector3d> positions;
  positions.reserve(poses.size());
  for (const Rigid3d& pose : poses) positions.push_back(pose.translation);
  return positions;
}

// Per channel.
Eigen::RowVectorXd Largest(const std::vector<Eigen::MatrixXd>& coefficients) {
  Eigen::RowVectorXd largest = Eigen::RowVectorXd::Zero(coefficients[0].cols());
  for (const Eigen::MatrixXd& scale : coefficients) {
    largest = largest.cwiseMax(scale.cwiseAbs().colwise().maxCoeff());
  }
  return largest;
}

}  // namespace

absl::Status CheckHasEdges(const SparseMatrix& laplacian) {
  if (laplacian.nonZeros() > laplacian.rows()) return absl::OkStatus();
  return absl::FailedPreconditionError("graph: no edge between its nodes; is radius_m too small?");
}

DiscrepancyFilter::DiscrepancyFilter(const RadiusGraphOptions& rule, const WaveletOptions& wavelets,
                                     const GraphReuse& reuse)
    : rule_(rule), wavelets_(wavelets), reuse_(reuse) {}

absl::StatusOr<Eigen::MatrixXd> DiscrepancyFilter::Filter(
    const std::vector<Rigid3d>& poses, const Eigen::MatrixXd& signal_difference) {
  if (signal_difference.rows() != poses.size() || !signal_difference.allFinite()) {
    Forget();
    return absl::InvalidArgumentError("signals: not finite, or not one row for each node");
  }
  reused_graph_ = StillFits(poses);
  reused_coefficients_ = false;
  absl::Status status = reused_graph_ ? absl::OkStatus() : BuildGraph(poses);
  const bool exact =
      wavelets_.method == FilterMethod::kExact ||
      (wavelets_.method == FilterMethod::kAuto && poses.size() <= wavelets_.exact_up_to_nodes);
  if (status.ok() && exact) return WaveletDiscrepancy(laplacian_, signal_difference, wavelets_);
  if (status.ok() && !coefficients_.empty()) {
    const absl::StatusOr<bool> changed = FilterChange(signal_difference);
    status = changed.status();
    reused_coefficients_ = changed.ok() && *changed;
  }
  if (status.ok() && !reused_coefficients_) status = FilterAll(signal_difference);
  if (!status.ok()) {
    Forget();
    return status;
  }
  return BandSums(coefficients_);
}

bool DiscrepancyFilter::StillFits(const std::vector<Rigid3d>& poses) const {
  if (poses.size() != poses_.size() || poses.empty()) return false;
  // Poses on one line leave the alignment open: then only a still frame will do.
  const absl::StatusOr<Rigid3d> aligned =
      UmeyamaAlignment(Positions(poses), Positions(poses_), AlignmentMode::kSe3);
  const Rigid3d psi_from_map = aligned.ok() ? *aligned : Rigid3d();
  for (size_t i = 0; i < poses.size(); ++i) {
    const Rigid3d moved = poses_[i].Inverse() * (psi_from_map * poses[i]);
    if (!(moved.translation.norm() <= reuse_.translation_tolerance_m) ||
        !(LogSO3(moved.rotation).norm() <= reuse_.rotation_tolerance_rad)) {
      return false;
    }
  }
  return true;
}

absl::Status DiscrepancyFilter::BuildGraph(const std::vector<Rigid3d>& poses) {
  Forget();  // first: a robot need not hold both
  ASSIGN_OR_RETURN(laplacian_, RadiusGraphLaplacian(poses, rule_));
  RETURN_IF_ERROR(CheckHasEdges(laplacian_));
  poses_ = poses;
  return absl::OkStatus();
}

absl::Status DiscrepancyFilter::FilterAll(const Eigen::MatrixXd& signal_difference) {
  coefficients_.clear();
  ASSIGN_OR_RETURN(
      FilterResult result,
      FastFilter(laplacian_, signal_difference, wavelets_.num_scales, wavelets_.tolerance, lmax_));
  lmax_ = result.lmax;
  coefficients_ = std::move(result.coefficients);
  difference_ = signal_difference;
  error_ = result.error_estimate * Largest(coefficients_);
  return absl::OkStatus();
}

absl::StatusOr<bool> DiscrepancyFilter::FilterChange(const Eigen::MatrixXd& signal_difference) {
  if (signal_difference.cols() != difference_.cols()) return false;
  const Eigen::MatrixXd change = signal_difference - difference_;
  const Eigen::RowVectorXd room =
      kErrorsTogether * wavelets_.tolerance * Largest(coefficients_) - error_;
  const Eigen::RowVectorXd size = change.cwiseAbs().colwise().maxCoeff();
  // The kernels are at most 1, so the change of a coefficient is about that of the signal. A
  // quarter of the room for each.
  double tolerance = kCoarsest;
  for (Eigen::Index c = 0; c < size.size(); ++c) {
    if (size[c] > 0) tolerance = std::min(tolerance, 0.25 * room[c] / size[c]);
  }
  if (tolerance <= wavelets_.tolerance) return false;
  if (size.maxCoeff() > 0) {
    ASSIGN_OR_RETURN(const FilterResult result,
                     FastFilter(laplacian_, change, wavelets_.num_scales, tolerance, lmax_));
    error_ += result.error_estimate * Largest(result.coefficients);
    for (size_t s = 0; s < coefficients_.size(); ++s) coefficients_[s] += result.coefficients[s];
    difference_ = signal_difference;
  }
  return (error_.array() <= kErrorsTogether * wavelets_.tolerance * Largest(coefficients_).array())
      .all();
}

void DiscrepancyFilter::Forget() {
  poses_.clear();
  laplacian_ = SparseMatrix();
  lmax_ = 0;
  coefficients_.clear();
}

}  // namespace overtone
