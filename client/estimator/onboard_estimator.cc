// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/estimator/onboard_estimator.h"

#include <cmath>
#include <utility>

#include "Eigen/Cholesky"
#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {
namespace {

absl::Status Invalid(absl::string_view what, absl::string_view why) {
  return absl::InvalidArgumentError(absl::StrCat(what, ": ", why));
}

// With the quaternion normalised.
absl::StatusOr<Rigid3d> CheckedTransform(const Rigid3d& transform, absl::string_view what) {
  if (!transform.translation.allFinite() || !(std::abs(transform.rotation.norm() - 1) <= 1e-3)) {
    return Invalid(what, "transform is not finite or its quaternion not of unit length");
  }
  return Rigid3d(transform.rotation.normalized(), transform.translation);
}

absl::StatusOr<Matrix6d> Information(const Matrix6d& covariance, absl::string_view what) {
  if (!covariance.allFinite()) return Invalid(what, "covariance is not finite");
  const double asymmetry = (covariance - covariance.transpose()).cwiseAbs().maxCoeff();
  const Eigen::LLT<Matrix6d> factor(covariance);
  if (asymmetry > 1e-9 * covariance.cwiseAbs().maxCoeff() || factor.info() != Eigen::Success) {
    return Invalid(what, "covariance is not symmetric positive definite");
  }
  const Matrix6d information = factor.solve(Matrix6d::Identity());
  if (!information.allFinite()) return Invalid(what, "covariance is singular");
  return information;
}

}  // namespace

absl::Status OnboardEstimator::AddKeyframe(int64_t index, Timestamp stamp,
                                           const Rigid3d& previous_from_this,
                                           const Matrix6d& covariance) {
  const std::string what = absl::StrCat("keyframe ", index);
  OdometryStep step;
  ASSIGN_OR_RETURN(step.previous_from_this, CheckedTransform(previous_from_this, what));
  absl::MutexLock lock(&mutex_);
  if (poses_.empty()) {
    if (index < 0) return Invalid(what, "negative index");
    first_index_ = index;
    poses_.push_back(step.previous_from_this);
  } else {
    const int64_t expected = first_index_ + static_cast<int64_t>(poses_.size());
    if (index != expected) return Invalid(what, absl::StrCat("expected index ", expected));
    if (!(stamp > stamps_.back())) return Invalid(what, "stamp does not increase");
    step.covariance = covariance;
    ASSIGN_OR_RETURN(step.information, Information(covariance, what));
    poses_.push_back(poses_.back() * step.previous_from_this);
  }
  stamps_.push_back(stamp);
  odometry_.push_back(step);
  return absl::OkStatus();
}

std::vector<OnboardPose> OnboardEstimator::Trajectory() {
  absl::MutexLock lock(&mutex_);
  std::vector<OnboardPose> trajectory;
  trajectory.reserve(poses_.size());
  for (int i = 0; i < poses_.size(); ++i) {
    trajectory.push_back({first_index_ + i, stamps_[i], poses_[i]});
  }
  return trajectory;
}

int OnboardEstimator::NumConstraints() const {
  absl::MutexLock lock(&mutex_);
  return static_cast<int>(chords_.size());
}

int64_t OnboardEstimator::FactorNonZeros() const {
  absl::MutexLock lock(&mutex_);
  return factor_non_zeros_;
}

absl::Status OnboardEstimator::Insert(const Constraint& constraint, Chords& chords) const {
  const std::string what = absl::StrCat("constraint ", constraint.id);
  const int64_t end = first_index_ + static_cast<int64_t>(poses_.size());
  for (const int64_t index : {constraint.from, constraint.to}) {
    if (index < first_index_ || index >= end) {
      return Invalid(what, absl::StrCat("no keyframe ", index));
    }
  }
  if (constraint.from == constraint.to) return Invalid(what, "both ends are the same keyframe");
  Chord chord;
  chord.from = static_cast<int>(constraint.from - first_index_);
  chord.to = static_cast<int>(constraint.to - first_index_);
  ASSIGN_OR_RETURN(chord.from_tform_to, CheckedTransform(constraint.from_tform_to, what));
  ASSIGN_OR_RETURN(chord.information, Information(constraint.covariance, what));
  chords[constraint.id] = chord;
  return absl::OkStatus();
}

absl::StatusOr<OnboardEstimator::Chords> OnboardEstimator::Merge(
    const ConstraintBatch& batch) const {
  Chords chords = chords_;
  for (const std::string& id : batch.retract) {
    if (chords.erase(id) == 0) return Invalid(absl::StrCat("constraint ", id), "not held");
  }
  for (const Constraint& constraint : batch.update) {
    if (chords.count(constraint.id) == 0) {
      return Invalid(absl::StrCat("constraint ", constraint.id), "not held");
    }
    RETURN_IF_ERROR(Insert(constraint, chords));
  }
  for (const Constraint& constraint : batch.add) RETURN_IF_ERROR(Insert(constraint, chords));
  return chords;
}

absl::Status OnboardEstimator::ApplyConstraints(const ConstraintBatch& batch) {
  absl::MutexLock lock(&mutex_);
  ASSIGN_OR_RETURN(Chords chords, Merge(batch));
  if (poses_.empty()) return absl::OkStatus();
  std::vector<Chord> chord_list;
  for (const auto& [id, chord] : chords) chord_list.push_back(chord);
  ASSIGN_OR_RETURN(ChainSmootherResult smoothed,
                   SmoothChain(poses_, odometry_, chord_list, ChainSmootherOptions()));
  poses_ = std::move(smoothed.poses);
  chords_ = std::move(chords);
  factor_non_zeros_ = smoothed.factor_non_zeros;
  return absl::OkStatus();
}

}  // namespace overtone
