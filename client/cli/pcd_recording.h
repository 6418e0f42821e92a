// SPDX-License-Identifier: Apache-2.0
// Folders of point clouds with odometry, as LiDAR odometry packages leave them behind.
#ifndef OVERTONE_CLIENT_CLI_PCD_RECORDING_H_
#define OVERTONE_CLIENT_CLI_PCD_RECORDING_H_

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "overtone/client/cli/dataset.h"

namespace overtone {

// One robot, named after its folder:
//   Scans/NNNNNN.pcd   points in the body frame of row N of the odometry, N from 0; read when
//   needed odom_poses.txt     rows of 3 x 4 numbers, mission_from_body times.txt          seconds,
//   as many, increasing ground_truth.txt   optional: rows of 3 x 4 numbers, as many, in one frame
//   for all robots degenerate.txt     optional: rows "N x y z": the motion into row N was poorly
//   observed along
//                      this direction of its body, 0 0 0: along any
// A folder without odom_poses.txt whose subfolders look like that holds a robot in each.
//
// NotFound: a file; InvalidArgument "file:line: what" or "file: what".
absl::StatusOr<std::vector<Recording>> ReadPcdRecordings(const std::string& folder);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_PCD_RECORDING_H_
