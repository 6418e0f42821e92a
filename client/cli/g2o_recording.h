// SPDX-License-Identifier: Apache-2.0
// Recordings and closures out of g2o files.
#ifndef OVERTONE_CLIENT_CLI_G2O_RECORDING_H_
#define OVERTONE_CLIENT_CLI_G2O_RECORDING_H_

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "overtone/client/cli/dataset.h"

namespace overtone {

// One robot: the odometry edges of the file, composed from its first vertex on, as the run; its
// other edges as closures. Stamps are made: 10 Hz by vertex id. InvalidArgument: a vertex that no
// odometry edge reaches.
absl::StatusOr<Recording> ReadG2oRecording(const std::string& path);

// The loop edges of a file alone, vertex id = frame number of the recordings. Planar edges know x,
// y and the heading; the three other directions are held with 1 m and 0.1 rad.
//
// `kitti_camera`: poses of the recordings are those of a camera (x right, y down, z ahead) and the
// graph lies in the ground plane, x ahead and y left: x = camera z, y = -camera x, heading about
// -camera y.
absl::StatusOr<std::vector<FrameClosure>> ReadG2oClosures(const std::string& path,
                                                          bool kitti_camera);

// The 3 x 4 matrix of a file, row by row on one or several lines. InvalidArgument: not a rigid
// motion.
absl::StatusOr<Rigid3d> ReadAlignment(const std::string& path);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_G2O_RECORDING_H_
