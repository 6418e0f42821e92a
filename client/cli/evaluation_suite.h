// SPDX-License-Identifier: Apache-2.0
// What `overtone evaluate` can run: suites of experiments. A new suite is one more entry of the
// list in the .cc.
#ifndef OVERTONE_CLIENT_CLI_EVALUATION_SUITE_H_
#define OVERTONE_CLIENT_CLI_EVALUATION_SUITE_H_

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "overtone/client/cli/replay_options.h"

namespace overtone {

struct Experiment {
  std::string name;   // of its folder and rows: letters, digits, '_'
  std::string title;  // for people: where, who, and what goes wrong
  // Makes or finds the data and says how to play it; all but `out`. `folder` is the experiment's
  // own, `seed` decides whatever is random, `data` is where public recordings lie. Progress goes to
  // stderr.
  std::function<absl::StatusOr<ReplayOptions>(const std::string& folder, uint64_t seed,
                                              const std::string& data)>
      prepare;
};

struct EvaluationSuite {
  std::string name;
  std::string description;  // one sentence
  std::vector<Experiment> experiments;
  // True: the data are public recordings (--data), and every selection strategy is tried on each; a
  // run with the real client for the table of robots is left to `overtone replay`.
  bool curves = false;
};

const std::vector<EvaluationSuite>& EvaluationSuites();

// InvalidArgument with the names there are. The suite lives as long as the program.
absl::StatusOr<const EvaluationSuite*> FindEvaluationSuite(absl::string_view name);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_EVALUATION_SUITE_H_
