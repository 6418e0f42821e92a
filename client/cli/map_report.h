// SPDX-License-Identifier: Apache-2.0
// A server's map as it stands, gathered into what the report shows.
#ifndef OVERTONE_CLIENT_CLI_MAP_REPORT_H_
#define OVERTONE_CLIENT_CLI_MAP_REPORT_H_

#include <string>

#include "absl/status/statusor.h"
#include "overtone/client/cli/admin_client.h"
#include "overtone/client/cli/run_result.h"

namespace overtone {

// Trajectories, odometry, closures with their verdicts, and what the robots reported of their last
// comparison. Of a mission too long for one message the odometry is left out. NotFound: no such
// map.
absl::StatusOr<RunResult> FetchMap(AdminClient& client, const std::string& map);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_MAP_REPORT_H_
