// SPDX-License-Identifier: Apache-2.0
// The files of a run: <robot>/{onboard,server,corrected}.tum, constraints.csv, closures.csv,
// metrics.json, report.html.
#ifndef OVERTONE_CLIENT_CLI_RESULTS_H_
#define OVERTONE_CLIENT_CLI_RESULTS_H_

#include <string>

#include "absl/status/status.h"
#include "overtone/client/cli/json_codec.h"
#include "overtone/client/cli/run_result.h"

namespace overtone {

// Into an existing folder, over what is there.
absl::Status WriteResults(const RunResult& result, const std::string& folder);

// constraints.csv: robot,id,kind,from,to,score,revision,action; every change in time order, robot
// by robot.
absl::Status WriteConstraints(const std::string& path, const RunResult& result);

// metrics.json: figures only, no trajectories. Lengths in metres, times in seconds or as named,
// absent figures null.
Json Metrics(const RunResult& result);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_RESULTS_H_
