// SPDX-License-Identifier: Apache-2.0
// The table of an evaluation, in the form of the paper's: onboard, server and corrected RMSE of
// every robot, and what the map that gave them was made of.
#ifndef OVERTONE_CLIENT_CLI_EVALUATION_TABLE_H_
#define OVERTONE_CLIENT_CLI_EVALUATION_TABLE_H_

#include <optional>
#include <string>
#include <vector>

#include "overtone/client/cli/evaluation_suite.h"
#include "overtone/client/cli/run_result.h"

namespace overtone {

struct EvaluationRow {
  std::string experiment;
  std::string robot;  // "team": all of them
  double path_m = 0;  // of the odometry
  size_t keyframes = 0;
  // Of positions, each robot aligned to the ground truth by itself; of a team over the keyframes of
  // all. Absent: no ground truth.
  std::optional<double> onboard_rmse_m, server_rmse_m, corrected_rmse_m;
  // Loop closures with an end in this robot's run, by whoever proposed them. Wrong: in use at the
  // end against the ground truth.
  int closures_proposed = 0, closures_in_use = 0, closures_wrong = 0;
  size_t constraints = 0;  // in force at the end
  // Of the map, and of the whole replay: on the team's row.
  std::optional<int> components;  // 1: all robots are tied together
  std::optional<double> seconds;
};

// One for each robot, then the team's.
std::vector<EvaluationRow> EvaluationRows(const std::string& experiment, const RunResult& run);

// As aligned columns; lines of a header and each row. Absent figures are "-".
std::string FormatEvaluation(const std::vector<EvaluationRow>& rows);

// experiment,robot,path_m,keyframes,onboard_rmse,server_rmse,corrected_rmse,closures_proposed,
// closures_in_use,closures_wrong_in_use,constraints,components,seconds; absent figures are empty.
std::string EvaluationCsv(const std::vector<EvaluationRow>& rows);

// A page: the suite, its experiments, the table, and how to read it.
std::string EvaluationMarkdown(const EvaluationSuite& suite, uint64_t seed,
                               const std::vector<EvaluationRow>& rows);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_EVALUATION_TABLE_H_
