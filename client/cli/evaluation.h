// SPDX-License-Identifier: Apache-2.0
// Estimates against ground truth that has holes.
#ifndef OVERTONE_CLIENT_CLI_EVALUATION_H_
#define OVERTONE_CLIENT_CLI_EVALUATION_H_

#include <optional>
#include <vector>

#include "overtone/client/cli/run_result.h"

namespace overtone {

// ATE after SE(3) alignment over the poses of `estimate` that have a ground truth at the same place
// of `ground_truth`, which may be longer. Absent: too few, or all on a line.
std::optional<TrajectoryError> ErrorAgainst(
    const std::vector<Rigid3d>& estimate, const std::vector<std::optional<Rigid3d>>& ground_truth);

// Fills the three errors of `robot` from its trajectories.
void Evaluate(RobotResult* robot);

// The constraints that adding, updating and retracting leave in force, by id.
std::vector<Constraint> ActiveConstraints(const std::vector<ConstraintRecord>& records);

// The p-quantile (0..1) of the comparisons' compare_ms, nearest rank; 0 when there are none.
double CompareQuantile(const RobotResult& robot, double p);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_EVALUATION_H_
