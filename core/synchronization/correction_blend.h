// SPDX-License-Identifier: Apache-2.0
// A correction moves the newest pose at once; what follows it, a controller above all, had better
// see it move slowly.
#ifndef OVERTONE_CORE_SYNCHRONIZATION_CORRECTION_BLEND_H_
#define OVERTONE_CORE_SYNCHRONIZATION_CORRECTION_BLEND_H_

#include "absl/status/status.h"
#include "overtone/core/common/timestamp.h"
#include "overtone/core/geometry/se3.h"

namespace overtone {

// How fast a correction may move the pose that controllers see, on top of its own motion. Infinite:
// at once.
struct BlendLimits {
  double max_velocity_m_per_s = 0.1;
  double max_turn_rad_per_s = 0.1;

  absl::Status Validate() const;  // InvalidArgument naming the member
};

// Seconds in which a pose gets from `before` to `after`, both seen from one frame, in a straight
// line and by one turn.
double BlendSeconds(const Rigid3d& before, const Rigid3d& after, const BlendLimits& limits);

// Fades corrections out of a pose: position linearly, rotation along the geodesic, each on its own,
// so that neither the robot's turning nor its distance from the origin adds to a correction's
// speed. Not thread-safe.
class CorrectionBlender {
 public:
  explicit CorrectionBlender(const BlendLimits& limits) : limits_(limits) {}

  // At `now` the estimate of the newest pose became `after` where it was `before`: the host's own,
  // not what Blend makes of it. What was not faded out yet is faded out with it, in as long as both
  // together need.
  void Corrected(const Rigid3d& before, const Rigid3d& after, Timestamp now);

  // For controllers: estimate_from_body as if the corrections so far had come bit by bit.
  Rigid3d Blend(const Rigid3d& estimate_from_body, Timestamp now) const;

 private:
  const BlendLimits limits_;
  // Of the estimate less what was shown, at `start_`, in the estimate's axes.
  Eigen::Vector3d translation_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d rotation_ = Eigen::Vector3d::Zero();
  Timestamp start_;
  double seconds_ = 0;
};

}  // namespace overtone

#endif  // OVERTONE_CORE_SYNCHRONIZATION_CORRECTION_BLEND_H_
