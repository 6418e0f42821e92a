// SPDX-License-Identifier: Apache-2.0
// The numbers behind the report's plots.
#ifndef OVERTONE_CLIENT_CLI_REPORT_DATA_H_
#define OVERTONE_CLIENT_CLI_REPORT_DATA_H_

#include <string>

#include "overtone/client/cli/run_result.h"

namespace overtone {

// JSON for report_page.js, safe inside a script element. Everything is in the server's map frame:
// a robot's ground truth is laid on its server estimate by the alignment of its server error, its
// other estimates on the ground truth by theirs (without ground truth: on the server estimate).
// Positions in cm steps, errors in mm steps, missing and infinite ones null.
std::string ReportData(const RunResult& result);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_REPORT_DATA_H_
