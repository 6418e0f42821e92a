// SPDX-License-Identifier: Apache-2.0
// Estimated trajectories against relative poses that are known to be true.
#ifndef OVERTONE_CLIENT_CLI_RELATION_EVALUATION_H_
#define OVERTONE_CLIENT_CLI_RELATION_EVALUATION_H_

#include <vector>

#include "overtone/client/cli/robot_plan.h"
#include "overtone/client/cli/run_result.h"

namespace overtone {

// Of (from_i^-1 to_i)^-1 * relation_i over all relations that an estimate knows both ends of in one
// frame: onboard and corrected within a robot, the server's between anchored robots too. No
// alignment. Kuemmerle et al., Autonomous Robots 27(4), 2009, equation 3 with translation and
// rotation apart. In the order onboard, server, corrected; empty without relations.
//
// `plans` and `robots` belong together, index by index.
std::vector<RelationErrors> EvaluateRelations(const std::vector<LoopClosure>& relations,
                                              const std::vector<RobotPlan>& plans,
                                              const std::vector<RobotResult>& robots);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_RELATION_EVALUATION_H_
