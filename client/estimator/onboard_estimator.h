// SPDX-License-Identifier: Apache-2.0
// A complete onboard estimator for hosts that have none, and the reference for those that do:
// odometry as it comes, corrected by the server's constraints as batches arrive.
#ifndef OVERTONE_CLIENT_ESTIMATOR_ONBOARD_ESTIMATOR_H_
#define OVERTONE_CLIENT_ESTIMATOR_ONBOARD_ESTIMATOR_H_

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/status/status.h"
#include "absl/synchronization/mutex.h"
#include "overtone/client/host_estimator.h"
#include "overtone/core/synchronization/chain_smoother.h"

namespace overtone {

// Thread-safe.
class OnboardEstimator : public HostEstimator {
 public:
  // Appends the next keyframe in O(1): indices count up by one from that of the first, stamps
  // increase. For the first keyframe `previous_from_this` is its pose in the estimate's frame,
  // where it stays, and the covariance is not read. InvalidArgument naming what is wrong; then
  // nothing is changed.
  absl::Status AddKeyframe(int64_t index, Timestamp stamp, const Rigid3d& previous_from_this,
                           const Matrix6d& covariance);

  std::vector<OnboardPose> Trajectory() override;

  // Adds, replaces and removes constraints by id, then smooths the whole trajectory once.
  // InvalidArgument naming the id: a keyframe we do not have, both ends the same, a transform that
  // is not finite, a covariance that is not positive definite, an update or retraction of an id we
  // do not hold. Then, and when the smoother fails (Internal), nothing is changed.
  absl::Status ApplyConstraints(const ConstraintBatch& batch) override;

  int NumConstraints() const;

  // Numbers in the Cholesky factor of the last smoothing (ChainSmootherResult::factor_non_zeros):
  // how far constraints have cost the chain its locality. 0 before the first batch.
  int64_t FactorNonZeros() const;

 private:
  using Chords = std::map<std::string, Chord>;

  absl::Status Insert(const Constraint& constraint, Chords& chords) const
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  absl::StatusOr<Chords> Merge(const ConstraintBatch& batch) const
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  mutable absl::Mutex mutex_;
  int64_t first_index_ ABSL_GUARDED_BY(mutex_) = 0;
  std::vector<Timestamp> stamps_ ABSL_GUARDED_BY(mutex_);
  std::vector<Rigid3d> poses_ ABSL_GUARDED_BY(mutex_);
  std::vector<OdometryStep> odometry_ ABSL_GUARDED_BY(mutex_);
  Chords chords_ ABSL_GUARDED_BY(mutex_);
  int64_t factor_non_zeros_ ABSL_GUARDED_BY(mutex_) = 0;
};

}  // namespace overtone

#endif  // OVERTONE_CLIENT_ESTIMATOR_ONBOARD_ESTIMATOR_H_
