// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/evaluation_table.h"

#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "overtone/client/cli/closure_judgement.h"
#include "overtone/client/cli/table.h"

namespace overtone {
namespace {

using Cells = std::vector<std::string>;

std::string Text(const std::optional<double>& value, int decimals, const std::string& absent) {
  return value.has_value() ? absl::StrFormat("%.*f", decimals, *value) : absent;
}

// In the order of EvaluationCsv.
Cells CellsOf(const EvaluationRow& row, const std::string& absent) {
  return {row.experiment,
          row.robot,
          absl::StrFormat("%.1f", row.path_m),
          absl::StrCat(row.keyframes),
          Text(row.onboard_rmse_m, 3, absent),
          Text(row.server_rmse_m, 3, absent),
          Text(row.corrected_rmse_m, 3, absent),
          absl::StrCat(row.closures_proposed),
          absl::StrCat(row.closures_in_use),
          absl::StrCat(row.closures_wrong),
          absl::StrCat(row.constraints),
          Text(row.components, 0, absent),
          Text(row.seconds, 1, absent)};
}

std::vector<Cells> Table(const std::vector<EvaluationRow>& rows) {
  std::vector<Cells> table = {{"experiment", "robot", "path [m]", "keyframes", "onboard [m]",
                               "server [m]", "corrected [m]", "closures", "in use", "wrong",
                               "constraints", "components", "time [s]"}};
  for (const EvaluationRow& row : rows) table.push_back(CellsOf(row, "-"));
  return table;
}

std::vector<ClosureResult> ClosuresOf(const RunResult& run, const std::string& robot) {
  std::vector<ClosureResult> closures;
  for (const ClosureResult& closure : run.closures) {
    if (closure.closure.from.mission.robot == robot || closure.closure.to.mission.robot == robot) {
      closures.push_back(closure);
    }
  }
  return closures;
}

void CountClosures(const std::vector<ClosureResult>& closures, EvaluationRow* row) {
  for (const auto& [proposer, score] : ScoreClosures(closures)) {
    row->closures_proposed += score.proposed;
    row->closures_in_use += score.accepted;
    row->closures_wrong += score.accepted_wrong;
  }
}

std::optional<double> Rmse(const std::optional<TrajectoryError>& error) {
  return error.has_value() ? std::optional<double>(error->rmse_m) : std::nullopt;
}

// Over the poses of all robots.
std::optional<double> TeamRmse(const RunResult& run,
                               std::optional<TrajectoryError> RobotResult::*error) {
  double sum_of_squares = 0;
  size_t count = 0;
  for (const RobotResult& robot : run.robots) {
    if (!(robot.*error).has_value()) continue;
    for (const double e : (robot.*error)->per_pose_m) sum_of_squares += e * e;
    count += (robot.*error)->per_pose_m.size();
  }
  if (count == 0) return std::nullopt;
  return std::sqrt(sum_of_squares / static_cast<double>(count));
}

std::string MarkdownRow(const Cells& cells) {
  return absl::StrCat("| ", absl::StrJoin(cells, " | "), " |\n");
}

}  // namespace

std::vector<EvaluationRow> EvaluationRows(const std::string& experiment, const RunResult& run) {
  std::vector<EvaluationRow> rows;
  EvaluationRow team;
  for (const RobotResult& robot : run.robots) {
    EvaluationRow row;
    row.experiment = experiment;
    row.robot = robot.name;
    row.path_m = robot.path_m;
    row.keyframes = robot.stamps.size();
    row.onboard_rmse_m = Rmse(robot.onboard_error);
    row.server_rmse_m = Rmse(robot.server_error);
    row.corrected_rmse_m = Rmse(robot.corrected_error);
    CountClosures(ClosuresOf(run, robot.name), &row);
    row.constraints = robot.active_constraints.size();
    team.path_m += row.path_m;
    team.keyframes += row.keyframes;
    team.constraints += row.constraints;
    rows.push_back(row);
  }
  team.experiment = experiment;
  team.robot = "team";
  team.onboard_rmse_m = TeamRmse(run, &RobotResult::onboard_error);
  team.server_rmse_m = TeamRmse(run, &RobotResult::server_error);
  team.corrected_rmse_m = TeamRmse(run, &RobotResult::corrected_error);
  CountClosures(run.closures, &team);
  team.components = run.components;
  team.seconds = run.wall_time_s;
  rows.push_back(team);
  return rows;
}

std::string FormatEvaluation(const std::vector<EvaluationRow>& rows) {
  return FormatTable(Table(rows));
}

std::string EvaluationCsv(const std::vector<EvaluationRow>& rows) {
  std::string text =
      "experiment,robot,path_m,keyframes,onboard_rmse,server_rmse,corrected_rmse,"
      "closures_proposed,closures_in_use,closures_wrong_in_use,constraints,components,seconds\n";
  for (const EvaluationRow& row : rows) {
    absl::StrAppend(&text, absl::StrJoin(CellsOf(row, ""), ","), "\n");
  }
  return text;
}

std::string EvaluationMarkdown(const EvaluationSuite& suite, uint64_t seed,
                               const std::vector<EvaluationRow>& rows) {
  std::string text = absl::StrCat("# ", suite.description, "\n\n`overtone evaluate --suite ",
                                  suite.name, " --seed ", seed, "`\n\n");
  for (const Experiment& experiment : suite.experiments) {
    absl::StrAppend(&text, "- **", experiment.name, "**: ", experiment.title, ".\n");
  }
  const std::vector<Cells> table = Table(rows);
  absl::StrAppend(&text, "\n", MarkdownRow(table[0]), MarkdownRow(Cells(table[0].size(), "---")));
  for (size_t i = 1; i < table.size(); ++i) absl::StrAppend(&text, MarkdownRow(table[i]));
  absl::StrAppend(&text,
                  "\nRMSE of positions against the ground truth after SE(3) alignment, robot by "
                  "robot; the team's over all keyframes.\nOnboard: odometry alone. Server: "
                  "optimised with all robots. Corrected: onboard with the server's constraints.\n"
                  "Closures of a robot are those with an end in its run; wrong are those in use "
                  "that the ground truth contradicts.\nComponents: 1 when all robots are tied "
                  "into one map. Time: of the whole replay.\n");
  return text;
}

}  // namespace overtone
