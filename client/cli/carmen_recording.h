// SPDX-License-Identifier: Apache-2.0
// CARMEN logs: wheel odometry and a planar laser. Montemerlo, Roy & Thrun, Perspectives on
// Standardization in Mobile Robot Programming, IROS 2003; many such logs are in the Radish
// repository.
#ifndef OVERTONE_CLIENT_CLI_CARMEN_RECORDING_H_
#define OVERTONE_CLIENT_CLI_CARMEN_RECORDING_H_

#include <string>

#include "absl/status/statusor.h"
#include "overtone/client/cli/dataset.h"

namespace overtone {

// The FLASER lines of a raw log, in the file's order, with the odometry pose in each of them, named
// after the file. Beams cover [-90, 90) degrees evenly; ranges within one percent of the log's
// longest are no returns. Clouds are in memory, in the plane z = 0, x ahead. Stamps are ipc_time; a
// clock that runs back stands still instead (1 us a scan).
//
// `reference`, if not empty, is the log of a SLAM-corrected run: its FLASER poses are the ground
// truth of the raw scans with the same ranges (to a centimetre), which become keyframes.
// `relations`, if not empty, has rows "t1 t2 dx dy dz roll pitch yaw": the pose of scan t2 as seen
// from scan t1, t their ipc_time. Kuemmerle et al., On Measuring the Accuracy of SLAM Algorithms,
// Autonomous Robots 27(4), 2009. Both ends become keyframes.
//
// NotFound: a file; InvalidArgument "file:line: what" or "file: what".
absl::StatusOr<Recording> ReadCarmenRecording(const std::string& log, const std::string& reference,
                                              const std::string& relations);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_CARMEN_RECORDING_H_
