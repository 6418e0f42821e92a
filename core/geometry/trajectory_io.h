// SPDX-License-Identifier: Apache-2.0
// Trajectories in the publishers' own text formats. Blank lines and lines that begin with # are
// passed over.
#ifndef OVERTONE_CORE_GEOMETRY_TRAJECTORY_IO_H_
#define OVERTONE_CORE_GEOMETRY_TRAJECTORY_IO_H_

#include <istream>
#include <ostream>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "overtone/core/geometry/trajectory.h"

namespace overtone {

enum class TrajectoryFormat {
  kTum,    // t[s] x y z qx qy qz qw, separated by blanks
  kEuroc,  // t[ns],x,y,z,qw,qx,qy,qz[,...]; further columns (velocity, biases) are not read
  kKitti,  // KITTI and MulRan: 12 numbers, row-major 3 x 4 [R t]; no stamps
};

// Rows of formats without stamps: row i is at i / rate, from 0.
inline constexpr double kDefaultRowRateHz = 10;

// Every stamp is read as text to the exact nanosecond. Poses are checked by parse_pose.h.
// NotFound: cannot be opened. InvalidArgument "path:line: what": a row too short, too long or not
// of numbers, not a pose, a stamp not after the previous one; or there is no row at all. DataLoss:
// reading failed on the way.
absl::StatusOr<Trajectory> ReadTrajectory(const std::string& path, TrajectoryFormat format,
                                          double row_rate_hz = kDefaultRowRateHz);
// The same from a stream; `name` stands for the path in errors.
absl::StatusOr<Trajectory> ReadTrajectory(std::istream& in, absl::string_view name,
                                          TrajectoryFormat format,
                                          double row_rate_hz = kDefaultRowRateHz);

// Numbers in the shortest form that reads back as the same double, stamps to the nanosecond (kKitti
// drops them). Unavailable: the file cannot be written.
absl::Status WriteTrajectory(const std::string& path, TrajectoryFormat format,
                             const Trajectory& trajectory);
void WriteTrajectory(std::ostream& out, TrajectoryFormat format, const Trajectory& trajectory);

}  // namespace overtone

#endif  // OVERTONE_CORE_GEOMETRY_TRAJECTORY_IO_H_
