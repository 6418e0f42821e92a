// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/table.h"

#include <algorithm>
#include <map>
#include <optional>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "overtone/client/cli/closure_summary.h"
#include "overtone/client/cli/evaluation.h"

namespace overtone {
namespace {

std::string Rmse(const std::optional<TrajectoryError>& error) {
  return error.has_value() ? absl::StrFormat("%.3f", error->rmse_m) : "-";
}

// "small/mid/large", and what there is of other kinds behind it.
std::string CountConstraints(const RobotResult& robot) {
  std::map<ConstraintKind, int> count;
  for (const Constraint& constraint : robot.active_constraints) ++count[constraint.kind];
  std::string text = absl::StrCat(count[ConstraintKind::kSmall], "/", count[ConstraintKind::kMid],
                                  "/", count[ConstraintKind::kLarge]);
  for (const ConstraintKind kind : {ConstraintKind::kDegenerate, ConstraintKind::kChord}) {
    if (count[kind] > 0) absl::StrAppend(&text, "+", count[kind], " ", ToString(kind));
  }
  return text;
}

std::string Rate(int64_t bytes, double duration_s) {
  if (!(duration_s > 0)) return "-";
  return absl::StrFormat("%.2f", static_cast<double>(bytes) / 1000 / duration_s);
}

std::vector<std::string> Row(const RobotResult& robot) {
  return {robot.name,
          absl::StrFormat("%.1f", robot.path_m),
          absl::StrCat(robot.graph_nodes),
          Rmse(robot.onboard_error),
          Rmse(robot.server_error),
          Rmse(robot.corrected_error),
          CountConstraints(robot),
          Rate(robot.bytes_up, robot.duration_s),
          Rate(robot.bytes_down, robot.duration_s),
          absl::StrFormat("%.1f/%.1f", CompareQuantile(robot, 0.5), CompareQuantile(robot, 0.99))};
}

}  // namespace

std::string FormatTable(const std::vector<std::vector<std::string>>& rows) {
  std::vector<size_t> widths;
  for (const auto& row : rows) {
    widths.resize(std::max(widths.size(), row.size()), 0);
    for (size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  std::string text;
  for (const auto& row : rows) {
    for (size_t i = 0; i < row.size(); ++i) {
      const std::string padding(widths[i] - row[i].size(), ' ');
      const bool last = i + 1 == row.size();
      if (i == 0) {
        absl::StrAppend(&text, row[i], last ? "" : padding);
      } else {
        absl::StrAppend(&text, "  ", padding, row[i]);
      }
    }
    absl::StrAppend(&text, "\n");
  }
  return text;
}

std::string FormatSummary(const RunResult& result) {
  std::vector<std::vector<std::string>> rows = {
      {"robot", "path [m]", "nodes", "onboard RMSE", "server RMSE", "corrected RMSE",
       "constraints s/m/l", "up [KB/s]", "down [KB/s]", "compare p50/p99 [ms]"}};
  for (const RobotResult& robot : result.robots) rows.push_back(Row(robot));
  return absl::StrCat(FormatTable(rows), "\n", FormatRelations(result), result.closures_note, "\n",
                      FormatClosures(result));
}

}  // namespace overtone
