// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/results.h"

#include <filesystem>
#include <fstream>
#include <map>
#include <optional>

#include "absl/strings/str_cat.h"
#include "overtone/client/cli/closure_file.h"
#include "overtone/client/cli/closure_summary.h"
#include "overtone/client/cli/evaluation.h"
#include "overtone/client/cli/output_files.h"
#include "overtone/client/cli/report.h"
#include "overtone/core/common/format_number.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/geometry/trajectory_io.h"

namespace overtone {
namespace {

absl::Status WriteTum(const std::string& path, const std::vector<Timestamp>& stamps,
                      const std::vector<Rigid3d>& poses) {
  Trajectory trajectory;
  for (size_t i = 0; i < poses.size(); ++i) trajectory.push_back({stamps[i], poses[i]});
  return WriteTrajectory(path, TrajectoryFormat::kTum, trajectory);
}

absl::Status WriteTrajectories(const RobotResult& robot, const std::string& folder) {
  RETURN_IF_ERROR(MakeFolder(folder));
  RETURN_IF_ERROR(WriteTum(folder + "/onboard.tum", robot.stamps, robot.onboard));
  RETURN_IF_ERROR(WriteTum(folder + "/server.tum", robot.stamps, robot.server));
  return WriteTum(folder + "/corrected.tum", robot.stamps, robot.corrected);
}

Json ErrorToJson(const std::optional<TrajectoryError>& error, bool positions_only) {
  if (!error.has_value()) return nullptr;
  return {{"rmse_m", error->rmse_m},
          {"mean_m", error->mean_m},
          {"median_m", error->median_m},
          {"max_m", error->max_m},
          {"rotation_rmse_rad", positions_only ? Json(nullptr) : Json(error->rotation_rmse_rad)}};
}

Json OptionalToJson(const std::optional<double>& value) {
  return value.has_value() ? Json(*value) : Json(nullptr);
}

// Constraints in force at the end, and changes over the run, by kind.
Json ConstraintCounts(const RobotResult& robot) {
  std::map<std::string, int> active, actions;
  for (const Constraint& constraint : robot.active_constraints) {
    ++active[std::string(ToString(constraint.kind))];
  }
  for (const ConstraintRecord& record : robot.constraints) {
    ++actions[std::string(ToString(record.action))];
  }
  return {{"in_force", active}, {"changes", actions}};
}

Json ComparisonToJson(const ComparisonRecord& comparison) {
  return {{"time_s", comparison.time_s},
          {"revision", comparison.revision},
          {"nodes", comparison.keyframe_index.size()},
          {"compare_ms", comparison.compare_ms},
          {"added", comparison.added},
          {"updated", comparison.updated},
          {"retracted", comparison.retracted},
          {"onboard_rmse_m", OptionalToJson(comparison.onboard_rmse_m)},
          {"corrected_rmse_m", OptionalToJson(comparison.corrected_rmse_m)}};
}

Json RobotToJson(const RobotResult& robot) {
  const bool positions_only = robot.ground_truth_positions_only;
  Json json = {{"name", robot.name},
               {"path_m", robot.path_m},
               {"duration_s", robot.duration_s},
               {"keyframes", robot.stamps.size()},
               {"graph_nodes", robot.graph_nodes},
               {"anchored", robot.anchored},
               {"onboard", ErrorToJson(robot.onboard_error, positions_only)},
               {"server", ErrorToJson(robot.server_error, positions_only)},
               {"corrected", ErrorToJson(robot.corrected_error, positions_only)},
               {"constraints", ConstraintCounts(robot)},
               {"bytes_up", robot.bytes_up},
               {"bytes_down", robot.bytes_down},
               {"compare_ms_p50", CompareQuantile(robot, 0.5)},
               {"compare_ms_p99", CompareQuantile(robot, 0.99)},
               {"comparisons", Json::array()}};
  for (const ComparisonRecord& comparison : robot.comparisons) {
    json["comparisons"].push_back(ComparisonToJson(comparison));
  }
  return json;
}

}  // namespace

absl::Status WriteConstraints(const std::string& path, const RunResult& result) {
  std::string text = "robot,id,kind,from,to,score,revision,action\n";
  for (const RobotResult& robot : result.robots) {
    for (const ConstraintRecord& record : robot.constraints) {
      const Constraint& constraint = record.constraint;
      absl::StrAppend(&text, robot.name, ",", constraint.id, ",", ToString(constraint.kind), ",",
                      constraint.from, ",");
      absl::StrAppend(&text, constraint.to, ",", FormatDouble(constraint.score), ",",
                      constraint.revision, ",", ToString(record.action));
      absl::StrAppend(&text, "\n");
    }
  }
  return WriteText(path, text);
}

Json Metrics(const RunResult& result) {
  std::map<std::string, int> verdicts;
  int outliers = 0, outliers_accepted = 0;
  for (const ClosureResult& closure : result.closures) {
    ++verdicts[closure.verdict];
    outliers += closure.outlier;
    outliers_accepted += closure.outlier && closure.verdict == "accepted";
  }
  Json settings = Json::object();
  for (const auto& [name, value] : result.settings) settings[name] = value;
  Json json = {{"dataset", result.dataset},
               {"command", result.command},
               {"settings", settings},
               {"closures",
                {{"note", result.closures_note},
                 {"simulated", result.closures_simulated},
                 {"count", result.closures.size()},
                 {"verdicts", verdicts},
                 {"outliers", outliers},
                 {"outliers_accepted", outliers_accepted},
                 {"by_proposer", ClosuresToJson(result)}}},
               {"relations", RelationsToJson(result)},
               {"revision", result.revision},
               {"components", result.components},
               {"wall_time_s", result.wall_time_s},
               {"robots", Json::array()}};
  for (const RobotResult& robot : result.robots) json["robots"].push_back(RobotToJson(robot));
  return json;
}

absl::Status WriteResults(const RunResult& result, const std::string& folder) {
  for (const RobotResult& robot : result.robots) {
    RETURN_IF_ERROR(WriteTrajectories(robot, absl::StrCat(folder, "/", robot.name)));
  }
  RETURN_IF_ERROR(WriteConstraints(folder + "/constraints.csv", result));
  RETURN_IF_ERROR(WriteClosures(folder + "/closures.csv", result));
  RETURN_IF_ERROR(WriteText(folder + "/metrics.json", Metrics(result).dump(1) + "\n"));
  return WriteReport(result, folder + "/report.html");
}

}  // namespace overtone
