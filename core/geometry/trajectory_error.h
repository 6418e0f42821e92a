// SPDX-License-Identifier: Apache-2.0
// How far an estimate is from the truth. Zhang & Scaramuzza, A Tutorial on Quantitative Trajectory
// Evaluation, IROS 2018; Sturm et al., IROS 2012.
#ifndef OVERTONE_CORE_GEOMETRY_TRAJECTORY_ERROR_H_
#define OVERTONE_CORE_GEOMETRY_TRAJECTORY_ERROR_H_

#include <vector>

#include "absl/status/statusor.h"
#include "overtone/core/geometry/rigid_alignment.h"
#include "overtone/core/geometry/se3.h"

namespace overtone {

struct TrajectoryError {
  double rmse_m = 0;  // of positions after alignment: the ATE
  double mean_m = 0;
  double median_m = 0;
  double max_m = 0;
  // Of the geodesic angle after alignment. Means little when the two body frames have different
  // axes.
  double rotation_rmse_rad = 0;
  Rigid3d reference_from_estimate;  // the alignment used
  std::vector<double> per_pose_m;
};

// Absolute trajectory error of estimate[i] against reference[i], after aligning all positions by
// `mode`. InvalidArgument: lengths differ or UmeyamaAlignment refuses.
absl::StatusOr<TrajectoryError> AbsoluteTrajectoryError(const std::vector<Rigid3d>& estimate,
                                                        const std::vector<Rigid3d>& reference,
                                                        AlignmentMode mode = AlignmentMode::kSe3);

struct RelativeError {
  double translation_rmse_m = 0;
  double rotation_rmse_rad = 0;  // full: geodesic angle
  double yaw_rmse_rad = 0;       // yaw-only: its part about the reference's z axis
  std::vector<double> per_pair_m;
};

// Relative pose error over `delta` poses: of (reference_i^-1 reference_i+delta)^-1 (estimate_i^-1
// estimate_i+delta), all i. Independent of any alignment. InvalidArgument: lengths differ, delta <
// 1, or fewer than delta + 1 poses.
absl::StatusOr<RelativeError> RelativePoseError(const std::vector<Rigid3d>& estimate,
                                                const std::vector<Rigid3d>& reference, int delta);

}  // namespace overtone

#endif  // OVERTONE_CORE_GEOMETRY_TRAJECTORY_ERROR_H_
