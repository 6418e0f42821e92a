// SPDX-License-Identifier: Apache-2.0
// A map as a text file.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_MAP_FILE_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_MAP_FILE_H_

#include <string>

#include "absl/status/statusor.h"
#include "overtone/core/mapping/map_snapshot.h"
#include "overtone/services/mapping_server/map_registry.h"
#include "overtone/v1/map_admin_service.pb.h"

namespace overtone {

// "t x y z qx qy qz qw", and before each mission the line "# robot/mission, component 0, anchored".
std::string TumFile(const MapSnapshot& snapshot);

// Vertices in the order of missions and keyframes; odometry edges and the accepted closures.
std::string G2oFileOf(const MapSnapshot& snapshot);

// The newest revision. InvalidArgument: unknown format. NotFound: no such map.
absl::StatusOr<std::string> MapFile(const MapRegistry& registry,
                                    const v1::ExportMapRequest& request);

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_MAP_FILE_H_
