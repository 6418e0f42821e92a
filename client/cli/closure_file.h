// SPDX-License-Identifier: Apache-2.0
// Loop closures from a text file, and to one.
#ifndef OVERTONE_CLIENT_CLI_CLOSURE_FILE_H_
#define OVERTONE_CLIENT_CLI_CLOSURE_FILE_H_

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "overtone/client/cli/robot_plan.h"
#include "overtone/client/cli/run_result.h"

namespace overtone {

// Rows "from_robot,from_stamp_s,to_robot,to_stamp_s,x,y,z,qx,qy,qz,qw,sigma_t,sigma_r[,...]" after
// a header line: the pose from_tform_to [m], its standard deviations per axis [m, rad]. Robots by
// name; the odometry poses nearest in time, at most 0.5 s away, are meant. Further columns are not
// read, but for "proposer" where there is one: rows of others than the robots are passed over, so
// that what one run's server found is not handed to the next one's. InvalidArgument names file and
// line.
absl::StatusOr<std::vector<LoopClosure>> ReadClosures(const std::string& path,
                                                      const std::vector<RobotPlan>& plans);

// The same columns, then from_index,to_index,verdict,weight,chi_square,simulated,outlier,proposer,
// measured,score, and what the ground truth says, empty where it is silent:
// true_distance_m,error_m,error_rad,right; and of the registration, empty where there was none:
// overlap,residual_m,open_directions.
absl::Status WriteClosures(const std::string& path, const RunResult& result);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_CLOSURE_FILE_H_
