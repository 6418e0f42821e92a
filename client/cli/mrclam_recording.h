// SPDX-License-Identifier: Apache-2.0
// The UTIAS Multi-Robot Cooperative Localization and Mapping data: five robots that drive among
// landmarks and see them, and each other, by barcode. Leung, Halpern, Barfoot & Liu, IJRR 30(8),
// 2011.
#ifndef OVERTONE_CLIENT_CLI_MRCLAM_RECORDING_H_
#define OVERTONE_CLIENT_CLI_MRCLAM_RECORDING_H_

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "overtone/client/cli/dataset.h"

namespace overtone {

// Standard deviations of a sighting, from the data itself: what range and bearing are off by, their
// rare gross errors apart. Everything drives on one floor.
inline constexpr double kMrclamRangeSigma_m = 0.15;
inline constexpr double kMrclamBearingSigma_rad = 0.02;
inline constexpr double kMrclamVerticalSigma_m = 0.02;

// Robots robot1, robot2, ... of a folder with Barcodes.dat and RobotN_{Odometry,Measurement}.dat,
// N = 1.. without gaps; RobotN_Groundtruth.dat where there is one, all in one frame. Velocities are
// integrated from the identity; a frame at every odometry row and at every measurement, which is a
// keyframe. Landmarks are landmark6, landmark7, ...; where they truly stand is not read. Sightings
// of unknown barcodes, of the robot itself and outside its odometry are counted in `note`.
//
// NotFound: a file; InvalidArgument "file:line: what".
absl::StatusOr<std::vector<Recording>> ReadMrclamRecordings(const std::string& folder);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_MRCLAM_RECORDING_H_
