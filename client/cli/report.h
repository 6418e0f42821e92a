// SPDX-License-Identifier: Apache-2.0
// The report of a replay: one HTML file with everything in it, that opens offline and stays below
// about half a megabyte however long the run was (lines are thinned out).
#ifndef OVERTONE_CLIENT_CLI_REPORT_H_
#define OVERTONE_CLIENT_CLI_REPORT_H_

#include <string>

#include "absl/status/status.h"
#include "overtone/client/cli/run_result.h"

namespace overtone {

// The page. Names from outside are escaped; missing parts (no ground truth, no comparison, no robot
// at all) are left out.
std::string RenderReport(const RunResult& result);

// Unavailable naming the path: the file cannot be written.
absl::Status WriteReport(const RunResult& result, const std::string& path);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_REPORT_H_
