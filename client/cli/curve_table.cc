// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/curve_table.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"

namespace overtone {
namespace {

using Cells = std::vector<std::string>;
using Robot = std::pair<std::string, std::string>;  // sequence, robot

Robot RobotOf(const CurveRow& row) { return {row.sequence, row.robot}; }

// In the order in which they were run.
std::vector<Robot> RobotsOf(const std::vector<CurveRow>& rows) {
  std::vector<Robot> robots;
  for (const CurveRow& row : rows) {
    if (std::find(robots.begin(), robots.end(), RobotOf(row)) == robots.end()) {
      robots.push_back(RobotOf(row));
    }
  }
  return robots;
}

std::string Number(const std::optional<double>& value, const std::string& absent) {
  return value.has_value() ? absl::StrFormat("%.4f", *value) : absent;
}

std::string MarkdownTable(const std::vector<Cells>& rows) {
  std::string text;
  for (size_t i = 0; i < rows.size(); ++i) {
    absl::StrAppend(&text, "| ", absl::StrJoin(rows[i], " | "), " |\n");
    if (i == 0)
      absl::StrAppend(&text, "|", absl::StrJoin(Cells(rows[0].size(), "---"), "|"), "|\n");
  }
  return text;
}

// The first row of a strategy of one robot at a budget; null: there is none.
const CurveRow* Find(const std::vector<CurveRow>& rows, const Robot& robot,
                     const std::string& strategy, int budget) {
  for (const CurveRow& row : rows) {
    if (row.mode == "once" && RobotOf(row) == robot && row.strategy == strategy &&
        row.budget == budget) {
      return &row;
    }
  }
  return nullptr;
}

std::string MeritSection(const std::vector<CurveRow>& rows) {
  Cells header = {"robot", "onboard [m]", "server [m]"};
  for (const int budget : CurveBudgets()) header.push_back(absl::StrCat(budget));
  std::vector<Cells> table = {header};
  std::map<Robot, Cells> cells;
  for (const BudgetMerit& merit : MeritOfBudgets(rows)) {
    cells[{merit.sequence, merit.robot}].push_back(absl::StrFormat(
        "%.2f (%s %.2f)", merit.knots_merit, merit.best_other, merit.best_other_merit));
  }
  for (const Robot& robot : RobotsOf(rows)) {
    const CurveRow* none = Find(rows, robot, "none", 0);
    if (none == nullptr) continue;
    Cells line = {absl::StrCat(robot.first, " ", robot.second),
                  absl::StrFormat("%.3f", none->onboard_rmse_m),
                  absl::StrFormat("%.3f", none->server_rmse_m)};
    line.insert(line.end(), cells[robot].begin(), cells[robot].end());
    table.push_back(line);
  }
  return absl::StrCat(
      "\n## RMSE over the server's, by edges\n\nOf `knots`, and in brackets of the best other "
      "strategy that keeps to the budget; 1 is the server's own, and what is below by chance "
      "counts as 1.\n\n",
      MarkdownTable(table));
}

std::string EdgesSection(const std::vector<CurveRow>& rows) {
  std::vector<Cells> table = {{"robot", "1.5", "1.25", "1.10", "top_n: edges (labels' RMSE [m])"}};
  for (const Robot& robot : RobotsOf(rows)) {
    if (Find(rows, robot, "none", 0) == nullptr) continue;
    Cells line = {absl::StrCat(robot.first, " ", robot.second)};
    for (const double merit : {1.5, 1.25, 1.1}) {
      int64_t edges = 0;
      for (const int budget : CurveBudgets()) {
        const CurveRow* row = Find(rows, robot, "knots", budget);
        if (edges == 0 && row != nullptr && Merit(*row) <= merit) edges = row->edges;
      }
      line.push_back(edges > 0 ? absl::StrCat(edges) : "-");
    }
    Cells top_n;
    for (const CurveRow& row : rows) {
      if (RobotOf(row) != robot || row.strategy != "top_n_labels" || row.edges == 0) continue;
      const int64_t edges = KnotsAsGoodAs(row, rows);
      top_n.push_back(absl::StrFormat("%d -> %s (%.3f)", row.edges,
                                      edges > 0 ? absl::StrCat(edges) : "-", row.corrected_rmse_m));
    }
    line.push_back(absl::StrJoin(top_n, ", "));
    table.push_back(line);
  }
  return absl::StrCat(
      "\n## Edges needed\n\nBy `knots` for so many times the server's RMSE, of the budgets tried; "
      "and in place of what 15, 30, 50 and 100 labels of `top_n` become, for the same RMSE.\n\n",
      MarkdownTable(table));
}

std::string PredictionSection(const std::vector<CurveRow>& rows) {
  std::vector<Cells> table = {{"robot", "median error", "largest error"}};
  for (const Robot& robot : RobotsOf(rows)) {
    std::vector<double> errors;
    for (const CurveRow& row : rows) {
      if (RobotOf(row) != robot || !row.predicted_m.has_value() || !(*row.predicted_m > 0))
        continue;
      errors.push_back(std::abs(*row.to_server_m / *row.predicted_m - 1));
    }
    if (errors.empty()) continue;
    std::sort(errors.begin(), errors.end());
    table.push_back({absl::StrCat(robot.first, " ", robot.second),
                     absl::StrFormat("%.1f %%", 100 * errors[errors.size() / 2]),
                     absl::StrFormat("%.1f %%", 100 * errors.back())});
  }
  return absl::StrCat(
      "\n## Prediction against what came of it\n\nRMSE of `knots` to the server's estimate: by how "
      "much it missed the prediction, over "
      "all budgets.\n\n",
      MarkdownTable(table));
}

std::string ContinuousSection(const std::vector<CurveRow>& rows) {
  std::vector<Cells> table = {{"robot", "strategy", "edges", "onboard [m]", "server [m]",
                               "corrected [m]", "median comparison [ms]"}};
  for (const CurveRow& row : rows) {
    if (row.mode != "continuous") continue;
    table.push_back(
        {absl::StrCat(row.sequence, " ", row.robot), row.strategy, absl::StrCat(row.edges),
         absl::StrFormat("%.3f", row.onboard_rmse_m), absl::StrFormat("%.3f", row.server_rmse_m),
         absl::StrFormat("%.3f", row.corrected_rmse_m), absl::StrFormat("%.1f", row.ms)});
  }
  if (table.size() == 1) return "";
  return absl::StrCat(
      "\n## Continuous\n\nCompared every 20 s of data time through the real client and server, "
      "n = 15. Edges: in force at the end.\n\n",
      MarkdownTable(table));
}

}  // namespace

std::string CurveCsv(const std::vector<CurveRow>& rows) {
  std::string text =
      "sequence,robot,strategy,mode,budget,edges,onboard_rmse,server_rmse,corrected_rmse,"
      "to_server_rmse,predicted_rmse,bytes,factor_nonzeros,ms\n";
  for (const CurveRow& row : rows) {
    absl::StrAppend(&text, row.sequence, ",", row.robot, ",", row.strategy, ",", row.mode, ",",
                    row.budget > 0 ? absl::StrCat(row.budget) : "", ",", row.edges, ",",
                    Number(row.onboard_rmse_m, ""), ",", Number(row.server_rmse_m, ""), ",",
                    Number(row.corrected_rmse_m, ""), ",", Number(row.to_server_m, ""), ",",
                    Number(row.predicted_m, ""), ",", row.bytes, ",",
                    row.factor_nonzeros.has_value() ? absl::StrCat(*row.factor_nonzeros) : "", ",",
                    absl::StrFormat("%.2f", row.ms), "\n");
  }
  return text;
}

double Merit(const CurveRow& row) {
  return std::max(row.corrected_rmse_m / row.server_rmse_m, 1.0);
}

std::vector<BudgetMerit> MeritOfBudgets(const std::vector<CurveRow>& rows) {
  std::vector<BudgetMerit> merits;
  for (const Robot& robot : RobotsOf(rows)) {
    for (const int budget : CurveBudgets()) {
      const CurveRow* knots = Find(rows, robot, "knots", budget);
      if (knots == nullptr) continue;
      BudgetMerit merit = {robot.first, robot.second, budget, "-", 0, Merit(*knots)};
      for (const std::string other : {"random", "uniform", "largest_edge_error", "top_n"}) {
        const CurveRow* row = Find(rows, robot, other, budget);
        if (row == nullptr) continue;
        if (merit.best_other != "-" && Merit(*row) >= merit.best_other_merit) continue;
        merit.best_other = other;
        merit.best_other_merit = Merit(*row);
      }
      merits.push_back(merit);
    }
  }
  return merits;
}

int64_t KnotsAsGoodAs(const CurveRow& row, const std::vector<CurveRow>& rows) {
  for (const int budget : CurveBudgets()) {
    const CurveRow* knots = Find(rows, RobotOf(row), "knots", budget);
    if (knots != nullptr && Merit(*knots) <= Merit(row)) return knots->edges;
  }
  return 0;
}

std::string CurveMarkdown(const std::string& title, const std::string& command,
                          const std::vector<CurveRow>& rows) {
  return absl::StrCat("# ", title, "\n\n`", command,
                      "`\n\nRMSE of positions against the ground "
                      "truth after SE(3) alignment. The server's map is made once; every strategy "
                      "then corrects the reference onboard estimator with one batch of so many "
                      "constraint edges. Loop closures are simulated from ground truth where a "
                      "title says so.\n",
                      MeritSection(rows), EdgesSection(rows), PredictionSection(rows),
                      ContinuousSection(rows));
}

}  // namespace overtone
