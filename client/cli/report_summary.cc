// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/report_summary.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace overtone {
namespace {

std::string Metres(const std::optional<TrajectoryError>& error) {
  return error ? absl::StrFormat("%.3f", error->rmse_m) : "-";
}

// Nearest rank; a dash without any comparison.
std::string CompareMs(const RobotResult& robot, double quantile) {
  std::vector<double> values;
  for (const ComparisonRecord& record : robot.comparisons) values.push_back(record.compare_ms);
  if (values.empty()) return "-";
  std::sort(values.begin(), values.end());
  const double rank = std::ceil(quantile * static_cast<double>(values.size()));
  return absl::StrFormat("%.1f", values[static_cast<size_t>(std::max(1.0, rank)) - 1]);
}

std::string KilobytesPerSecond(int64_t bytes, double duration_s) {
  return duration_s > 0 ? absl::StrFormat("%.2f", 1e-3 * static_cast<double>(bytes) / duration_s)
                        : "-";
}

// "12/3/4": small, mid, large in force at the end; other kinds by name behind.
std::string ConstraintCounts(const RobotResult& robot) {
  std::map<ConstraintKind, int> count;
  for (const Constraint& constraint : robot.active_constraints) ++count[constraint.kind];
  std::string text = absl::StrCat(count[ConstraintKind::kSmall], "/", count[ConstraintKind::kMid],
                                  "/", count[ConstraintKind::kLarge]);
  for (ConstraintKind kind : {ConstraintKind::kDegenerate, ConstraintKind::kChord}) {
    if (count[kind] > 0) absl::StrAppend(&text, "+", count[kind], " ", ToString(kind));
  }
  return text;
}

}  // namespace

std::vector<std::vector<std::string>> SummaryRows(const RunResult& result) {
  std::vector<std::vector<std::string>> rows = {
      {"robot", "path [m]", "nodes", "onboard RMSE", "server RMSE", "corrected RMSE",
       "constraints s/m/l", "up [KB/s]", "down [KB/s]", "compare p50/p99 [ms]"}};
  for (const RobotResult& robot : result.robots) {
    rows.push_back({robot.name, absl::StrFormat("%.1f", robot.path_m),
                    absl::StrCat(robot.graph_nodes), Metres(robot.onboard_error),
                    Metres(robot.server_error), Metres(robot.corrected_error),
                    ConstraintCounts(robot), KilobytesPerSecond(robot.bytes_up, robot.duration_s),
                    KilobytesPerSecond(robot.bytes_down, robot.duration_s),
                    absl::StrCat(CompareMs(robot, 0.5), "/", CompareMs(robot, 0.99))});
  }
  return rows;
}

}  // namespace overtone
