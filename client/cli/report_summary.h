// SPDX-License-Identifier: Apache-2.0
// The table of a run, as on the terminal.
#ifndef OVERTONE_CLIENT_CLI_REPORT_SUMMARY_H_
#define OVERTONE_CLIENT_CLI_REPORT_SUMMARY_H_

#include <string>
#include <vector>

#include "overtone/client/cli/run_result.h"

namespace overtone {

// Cells as plain text: the header, then a row for each robot. RMSE in metres; rates per second of
// data time, 1 KB = 1000 bytes; the time of a comparison by nearest rank; "-": nothing to measure.
std::vector<std::vector<std::string>> SummaryRows(const RunResult& result);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_REPORT_SUMMARY_H_
