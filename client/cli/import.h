// SPDX-License-Identifier: Apache-2.0
// Trajectories and pose graphs of other programs, uploaded into a map as missions.
#ifndef OVERTONE_CLIENT_CLI_IMPORT_H_
#define OVERTONE_CLIENT_CLI_IMPORT_H_

#include <cstdint>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "absl/time/time.h"
#include "overtone/client/cli/admin_client.h"
#include "overtone/client/cli/robot_recording_file.h"
#include "overtone/client/mapping_client_options.h"

namespace overtone {

struct ImportSource {
  std::string robot;  // an id
  std::string path;
  bool g2o = false;  // else TUM
};

// "ROBOT:FILE" or "FILE", whose name then names the robot; g2o by its ending. InvalidArgument: no
// robot's id can be made of it.
absl::StatusOr<ImportSource> ParseImportSource(absl::string_view text);

struct ImportOptions {
  std::string mission = "import";
  std::optional<double> keyframe_distance_m;  // absent: 0.4, of g2o every pose
  std::optional<double> keyframe_rotation_rad;
  std::string odometry_sigma;  // as `overtone replay` has it; empty: the default
};

// Errors name the file and line.
absl::StatusOr<RobotRecording> ReadImport(const ImportSource& source, const ImportOptions& options);

// How many of the recording's keyframes the map holds already; 0 also where there is no such map.
// AlreadyExists, saying what to do: a mission of that name is there, and is another one.
absl::StatusOr<int64_t> KeyframesThere(AdminClient& admin, const std::string& map,
                                       const RobotRecording& recording);

// Sends all that the server does not hold yet, and waits until it is stored. Sending again what is
// there changes nothing.
absl::Status UploadRecording(const RobotRecording& recording, MappingClientOptions options,
                             absl::Duration timeout);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_IMPORT_H_
