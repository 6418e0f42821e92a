// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_CLIENT_CLI_TABLE_H_
#define OVERTONE_CLIENT_CLI_TABLE_H_

#include <string>
#include <vector>

#include "overtone/client/cli/run_result.h"

namespace overtone {

// Rows of cells, the first one the header, as aligned columns: the first column to the left, the
// others to the right.
std::string FormatTable(const std::vector<std::vector<std::string>>& rows);

// The summary of a run: one row for each robot, the errors of relations, the sentence about the
// closures, and their verdicts.
std::string FormatSummary(const RunResult& result);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_TABLE_H_
