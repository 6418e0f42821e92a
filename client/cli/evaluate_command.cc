// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/evaluate_command.h"

#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "overtone/client/cli/client_flags.h"
#include "overtone/client/cli/curve_evaluation.h"
#include "overtone/client/cli/evaluation_suite.h"
#include "overtone/client/cli/evaluation_table.h"
#include "overtone/client/cli/exit_code.h"
#include "overtone/client/cli/output_files.h"
#include "overtone/client/cli/replay.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {
namespace {

struct EvaluateOptions {
  std::string suite = "paper";
  std::string out = "evaluation";
  std::string data = "../shared/data";
  bool continuous = false;
  ClientFlags client;  // its seed is everybody's
};

absl::StatusOr<std::vector<EvaluationRow>> RunExperiment(const Experiment& experiment,
                                                         const EvaluateOptions& options) {
  const std::string folder = absl::StrCat(options.out, "/", experiment.name);
  ASSIGN_OR_RETURN(ReplayOptions replay,
                   experiment.prepare(folder, options.client.seed, options.data));
  replay.out = absl::StrCat(folder, "/run");
  replay.client = options.client;
  ASSIGN_OR_RETURN(const RunResult result, RunReplay(replay));
  return EvaluationRows(experiment.name, result);
}

// What there is so far, so that an evaluation cut short leaves its first part.
absl::Status Write(const EvaluateOptions& options, const EvaluationSuite& suite,
                   const std::vector<EvaluationRow>& rows) {
  const std::string path = absl::StrCat(options.out, "/", suite.name);
  RETURN_IF_ERROR(WriteText(path + ".csv", EvaluationCsv(rows)));
  return WriteText(path + ".md", EvaluationMarkdown(suite, options.client.seed, rows));
}

absl::Status Evaluate(const EvaluateOptions& options) {
  ASSIGN_OR_RETURN(const EvaluationSuite* const suite, FindEvaluationSuite(options.suite));
  if (suite->curves) {
    return EvaluateCurves(*suite, {options.out, options.data, options.continuous, options.client});
  }
  std::vector<EvaluationRow> rows;
  int number = 0;
  for (const Experiment& experiment : suite->experiments) {
    std::cerr << "Experiment " << ++number << " of " << suite->experiments.size() << ", "
              << experiment.name << ": " << experiment.title << "\n";
    ASSIGN_OR_RETURN(const std::vector<EvaluationRow> added, RunExperiment(experiment, options));
    rows.insert(rows.end(), added.begin(), added.end());
    RETURN_IF_ERROR(Write(options, *suite, rows));
  }
  std::cout << FormatEvaluation(rows) << "\nWritten to " << options.out << "/" << suite->name
            << ".csv and .md\n";
  return absl::OkStatus();
}

int Run(const EvaluateOptions& options) {
  const absl::Status status = Evaluate(options);
  return status.ok() ? 0 : Fail("evaluate", status);
}

std::string SuitesForHelp() {
  std::string text = "Suites:\n";
  for (const EvaluationSuite& suite : EvaluationSuites()) {
    absl::StrAppend(&text, "  ", suite.name, ": ", suite.description, "\n");
    for (const Experiment& experiment : suite.experiments) {
      absl::StrAppend(&text, "    ", experiment.name, "\n");
    }
  }
  return text;
}

}  // namespace

void AddEvaluateCommand(CLI::App* app, std::function<int()>* run) {
  auto options = std::make_shared<EvaluateOptions>();
  CLI::App* command = app->add_subcommand(
      "evaluate", "Run a suite of experiments, and tabulate onboard, server and corrected RMSE");
  command->footer(absl::StrCat(
      SuitesForHelp(),
      "\nOne experiment after the other goes through the real client and server, as `overtone "
      "replay` does it;\n"
      "the server finds the loop closures itself. Writes <suite>.csv and <suite>.md, and for every "
      "experiment a\n"
      "folder with its data and its run, report.html among it. The same seed gives the same "
      "data.\n\n"
      "  overtone evaluate --suite paper --out evaluation/"));
  command->add_option("--suite", options->suite, "Which, see below")->capture_default_str();
  command->add_option("--out", options->out, "Folder to write to; an experiment's must be new")
      ->capture_default_str();
  command
      ->add_option("--data", options->data,
                   "Folder of the public recordings: euroc, mulran, kitti, mrclam, ...")
      ->capture_default_str();
  command->add_flag("--continuous", options->continuous,
                    "Public recordings: also play every strategy with a comparison every 20 s");
  AddClientFlags(command, &options->client);
  command->callback([options, run] { *run = [options] { return Run(*options); }; });
}

}  // namespace overtone
