// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/curve_evaluation.h"

#include <iostream>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "overtone/client/cli/constraint_curve.h"
#include "overtone/client/cli/correction_case.h"
#include "overtone/client/cli/curve_table.h"
#include "overtone/client/cli/evaluation.h"
#include "overtone/client/cli/output_files.h"
#include "overtone/client/cli/replay.h"
#include "overtone/client/cli/replay_input.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {
namespace {

// One comparison at the very end.
constexpr double kOnce_s = 1e9;

absl::StatusOr<RunResult> Play(const Experiment& experiment, const CurveEvaluation& options,
                               const std::string& strategy, double compare_every_s,
                               std::vector<RobotPlan>* plans) {
  const std::string folder = absl::StrCat(options.out, "/", experiment.name);
  ASSIGN_OR_RETURN(ReplayOptions replay,
                   experiment.prepare(folder, options.client.seed, options.data));
  replay.out = absl::StrCat(folder, "/", strategy);
  replay.client = options.client;
  replay.client.strategy = strategy;
  replay.compare_every_s = compare_every_s;
  if (plans != nullptr) {
    ASSIGN_OR_RETURN(ReplayInput input, MakeReplayInput(replay));
    *plans = std::move(input.plans);
  }
  return RunReplay(replay);
}

absl::Status AddOnce(const Experiment& experiment, const CurveEvaluation& options,
                     std::vector<CurveRow>* rows) {
  std::vector<RobotPlan> plans;
  ASSIGN_OR_RETURN(const RunResult run, Play(experiment, options, "none", kOnce_s, &plans));
  MappingClientOptions client;
  options.client.ApplyTo(&client);
  for (size_t i = 0; i < plans.size(); ++i) {
    ASSIGN_OR_RETURN(
        const CorrectionCase correction_case,
        MakeCorrectionCase(experiment.name, plans[i], run.robots[i], client.synchronization));
    ASSIGN_OR_RETURN(const std::vector<CurveRow> added,
                     ConstraintCurve(correction_case, client.synchronization));
    rows->insert(rows->end(), added.begin(), added.end());
  }
  return absl::OkStatus();
}

absl::Status AddContinuous(const Experiment& experiment, const CurveEvaluation& options,
                           std::vector<CurveRow>* rows) {
  for (const std::string strategy :
       {"all", "random", "uniform", "largest_edge_error", "threshold", "top_n", "knots"}) {
    ASSIGN_OR_RETURN(const RunResult run,
                     Play(experiment, options, strategy, ReplayOptions().compare_every_s, nullptr));
    for (const RobotResult& robot : run.robots) {
      if (!robot.corrected_error.has_value() || !robot.server_error.has_value()) continue;
      CurveRow row;
      row.sequence = experiment.name;
      row.robot = robot.name;
      row.strategy = strategy;
      row.mode = "continuous";
      row.budget = options.client.n;
      row.edges = static_cast<int64_t>(robot.active_constraints.size());
      row.onboard_rmse_m = robot.onboard_error->rmse_m;
      row.server_rmse_m = robot.server_error->rmse_m;
      row.corrected_rmse_m = robot.corrected_error->rmse_m;
      row.bytes = robot.bytes_down;
      row.ms = CompareQuantile(robot, 0.5);
      rows->push_back(row);
    }
  }
  return absl::OkStatus();
}

absl::Status WriteCurves(const CurveEvaluation& options, const EvaluationSuite& suite,
                         const std::vector<CurveRow>& rows) {
  const std::string path = absl::StrCat(options.out, "/", suite.name);
  const std::string command =
      absl::StrCat("overtone evaluate --suite ", suite.name, " --seed ", options.client.seed,
                   options.continuous ? " --continuous" : "");
  RETURN_IF_ERROR(WriteText(path + ".csv", CurveCsv(rows)));
  RETURN_IF_ERROR(WriteText(path + ".svg", CurveSvg(rows)));
  return WriteText(path + ".md", CurveMarkdown(suite.description, command, rows));
}

}  // namespace

absl::Status EvaluateCurves(const EvaluationSuite& suite, const CurveEvaluation& options) {
  std::vector<CurveRow> rows;
  for (const Experiment& experiment : suite.experiments) {
    std::cerr << experiment.name << ": " << experiment.title << "\n";
    RETURN_IF_ERROR(AddOnce(experiment, options, &rows));
    if (options.continuous) RETURN_IF_ERROR(AddContinuous(experiment, options, &rows));
    RETURN_IF_ERROR(WriteCurves(options, suite, rows));
  }
  std::cout << CurveMarkdown(suite.description, "", rows) << "\nWritten to " << options.out << "/"
            << suite.name << ".csv, .md and .svg\n";
  return absl::OkStatus();
}

}  // namespace overtone
