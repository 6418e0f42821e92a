// SPDX-License-Identifier: Apache-2.0
// What MapAdminService answers: views of the store and of the newest snapshot. Errors are relative
// to the request.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_MAP_LISTING_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_MAP_LISTING_H_

#include <functional>
#include <string>

#include "absl/status/statusor.h"
#include "overtone/services/mapping_server/map_registry.h"
#include "overtone/services/mapping_server/upload_sessions.h"
#include "overtone/v1/map_admin_service.pb.h"

namespace overtone {

// Of those that `visible` holds for.
absl::StatusOr<v1::ListMapsResponse> ListMaps(
    const MapRegistry& registry, const std::function<bool(const std::string& map)>& visible,
    const v1::ListMapsRequest& request);
// As stored: what is not in a revision yet counts.
absl::StatusOr<v1::ListRobotsResponse> ListRobots(const MapRegistry& registry,
                                                  const UploadSessions& sessions,
                                                  const v1::ListRobotsRequest& request);
// As in the newest revision; likewise below.
absl::StatusOr<v1::ListMissionsResponse> ListMissions(const MapRegistry& registry,
                                                      const v1::ListMissionsRequest& request);
// NotFound: no such mission. ResourceExhausted: does not fit into a message; ExportMap has no such
// limit.
absl::StatusOr<v1::GetTrajectoryResponse> GetTrajectory(const MapRegistry& registry,
                                                        const v1::GetTrajectoryRequest& request,
                                                        int64_t max_message_bytes);

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_MAP_LISTING_H_
