// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/estimation/pairwise_consistency.h"

#include <cmath>

#include "Eigen/Cholesky"
#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/geometry/positive_definite.h"

namespace overtone {
namespace {

// More new closures than this, and one search over all is quicker than one for each.
constexpr int kFewAdditions = 8;

Matrix6d Transport(const Rigid3d& transform, const Matrix6d& covariance) {
  const Matrix6d adjoint = Adjoint(transform);
  return adjoint * covariance * adjoint.transpose();
}

absl::Status CheckPosition(const char* name, int position, const UncertainTrajectory& trajectory) {
  if (position >= 0 && position < trajectory.Size()) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(name, " = ", position, " is out of range"));
}

}  // namespace

// Noise on the right of a factor is carried to the right end over the factors behind it:
// F Exp(d) G = F G Exp(Ad(G^-1) d), and that of z_ij^-1 is -Ad(z_ij) d.
double ConsistencyChiSquare(const InterMissionClosure& ij, const InterMissionClosure& kl,
                            const UncertainTrajectory& a, const UncertainTrajectory& b) {
  const Rigid3d j_from_l = b.Relative(ij.to, kl.to);
  const Rigid3d j_from_k = j_from_l * kl.from_tform_to.Inverse();
  const Rigid3d i_from_j_by_kl = a.Relative(ij.from, kl.from) * j_from_k.Inverse();
  const Rigid3d j_from_i_by_kl = i_from_j_by_kl.Inverse();
  const Vector6d error = Log(ij.from_tform_to.Inverse() * i_from_j_by_kl);
  const Matrix6d covariance = Transport(j_from_i_by_kl * ij.from_tform_to, ij.covariance) +
                              Transport(j_from_k, a.Covariance(ij.from, kl.from)) +
                              Transport(j_from_l, kl.covariance) + b.Covariance(kl.to, ij.to);
  return error.dot(covariance.llt().solve(error));
}

absl::Status PairwiseConsistencyOptions::Validate() const {
  if (!(chi_square_limit > 0) || !std::isfinite(chi_square_limit)) {
    return absl::InvalidArgumentError("chi_square_limit must be positive and finite");
  }
  return clique.Validate();
}

absl::Status PairwiseConsistency::Add(const InterMissionClosure& closure,
                                      const UncertainTrajectory& a, const UncertainTrajectory& b) {
  RETURN_IF_ERROR(CheckPosition("from", closure.from, a));
  RETURN_IF_ERROR(CheckPosition("to", closure.to, b));
  if (!closure.covariance.allFinite() || !IsPositiveDefinite(closure.covariance)) {
    return absl::InvalidArgumentError("covariance is not positive definite");
  }
  closures_.push_back(closure);
  graph_.AddNode();
  Compare(Size() - 1, a, b);
  return absl::OkStatus();
}

void PairwiseConsistency::Rebuild(const UncertainTrajectory& a, const UncertainTrajectory& b) {
  graph_ = BitGraph(Size());
  for (int k = 0; k < Size(); ++k) Compare(k, a, b);
  num_searched_ = 0;
}

void PairwiseConsistency::Compare(int k, const UncertainTrajectory& a,
                                  const UncertainTrajectory& b) {
  for (int l = 0; l < k; ++l) {
    const double chi_square = ConsistencyChiSquare(closures_[l], closures_[k], a, b);
    if (chi_square <= options_.chi_square_limit) graph_.Connect(l, k);
  }
}

const Clique& PairwiseConsistency::ConsistentSet() {
  if (num_searched_ == Size()) return set_;
  const bool few = Size() - num_searched_ <= kFewAdditions;
  while (few && num_searched_ > 0 && num_searched_ < Size() && set_.proven_maximum) {
    set_ = MaximumCliqueWithOneMore(graph_, num_searched_++, set_, options_.clique);
  }
  if (num_searched_ < Size()) set_ = MaximumClique(graph_, set_.members, options_.clique);
  num_searched_ = Size();
  return set_;
}

}  // namespace overtone
