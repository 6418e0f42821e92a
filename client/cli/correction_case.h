// SPDX-License-Identifier: Apache-2.0
// One robot's run and the server's finished estimate of it, ready to be corrected in many ways
// without playing it again.
#ifndef OVERTONE_CLIENT_CLI_CORRECTION_CASE_H_
#define OVERTONE_CLIENT_CLI_CORRECTION_CASE_H_

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "overtone/client/cli/robot_plan.h"
#include "overtone/client/cli/run_result.h"
#include "overtone/core/synchronization/selection_context.h"
#include "overtone/core/synchronization/synchronization_options.h"
#include "overtone/core/synchronization/trajectory_comparison.h"

namespace overtone {

struct CorrectionCase {
  std::string sequence;
  std::string robot;
  std::vector<Keyframe> keyframes;
  std::vector<std::optional<Rigid3d>> ground_truth;
  TrajectoryComparison comparison;  // all keyframes, the last revision
  SelectionContext context;         // odometry and its covariance; nothing in force
  double onboard_rmse_m = 0;        // against the ground truth, as the server's
  double server_rmse_m = 0;
  int64_t bytes_down = 0;  // of the run
};

// FailedPrecondition: no ground truth, or the server never had the mission.
absl::StatusOr<CorrectionCase> MakeCorrectionCase(const std::string& sequence,
                                                  const RobotPlan& plan, const RobotResult& robot,
                                                  const SynchronizationOptions& options);

struct CorrectionOutcome {
  double rmse_m = 0;       // against the ground truth
  double to_server_m = 0;  // against the server's estimate
  int64_t factor_nonzeros = 0;
};

// What the reference onboard estimator makes of the constraints, all in one batch.
absl::StatusOr<CorrectionOutcome> Correct(const CorrectionCase& correction_case,
                                          const std::vector<Constraint>& constraints);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_CORRECTION_CASE_H_
