// SPDX-License-Identifier: Apache-2.0
// What the host's estimator will make of a set of constraints, by doing it: odometry as the record
// has it, smoothed with them. Any constraints; chord_prediction.h is the closed form for knots.
#ifndef OVERTONE_CORE_SYNCHRONIZATION_HOST_PREDICTION_H_
#define OVERTONE_CORE_SYNCHRONIZATION_HOST_PREDICTION_H_

#include <vector>

#include "absl/status/statusor.h"
#include "overtone/core/synchronization/constraint.h"
#include "overtone/core/synchronization/odometry_record.h"
#include "overtone/core/synchronization/trajectory_comparison.h"

namespace overtone {

struct HostPrediction {
  // Of the comparison, increasing: all of them up to 2,000, else evenly many and those at which
  // constraints end.
  std::vector<int> rows;
  std::vector<Rigid3d> poses;  // of these: estimate_from_body, the first where it is now
  double rmse_m = 0;           // to the server's estimate, aligned_rmse.h

  // What `values`, one for each row of the comparison, has for these.
  std::vector<Rigid3d> Of(const std::vector<Rigid3d>& values) const;
};

// `in_force`: all constraints that the host will hold. Those with an end that the host does not
// have are left out. Internal: the smoother failed.
absl::StatusOr<HostPrediction> PredictHost(const TrajectoryComparison& comparison,
                                           const OdometryRecord& record, const OdometryModel& model,
                                           const std::vector<Constraint>& in_force);

// The comparison's rows as nodes of the host's estimate.
std::vector<NodePose> RowsOf(const TrajectoryComparison& comparison);

}  // namespace overtone

#endif  // OVERTONE_CORE_SYNCHRONIZATION_HOST_PREDICTION_H_
