// SPDX-License-Identifier: Apache-2.0
// A map as a text file.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_MAP_FILE_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_MAP_FILE_H_

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "overtone/core/geometry/trajectory_io.h"
#include "overtone/core/mapping/map_snapshot.h"
#include "overtone/services/mapping_server/map_registry.h"
#include "overtone/v1/map_admin_service.pb.h"

namespace overtone {

using SnapshotMissions = std::vector<const SnapshotMission*>;

// The rows of each mission, and before them the line "# robot/mission, component 0, anchored".
std::string TrajectoryFile(const SnapshotMissions& missions, TrajectoryFormat format);

// Vertices in the order of missions and keyframes; their odometry edges and the closures in use
// between them.
std::string G2oFileOf(const MapSnapshot& snapshot, const SnapshotMissions& missions);

// The newest revision. InvalidArgument: a format that is no text, or a bad mission. NotFound: no
// such map or mission.
absl::StatusOr<std::string> MapFile(const MapRegistry& registry,
                                    const v1::ExportMapRequest& request);

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_MAP_FILE_H_
