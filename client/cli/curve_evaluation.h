// SPDX-License-Identifier: Apache-2.0
// Selection strategies side by side on recorded runs.
#ifndef OVERTONE_CLIENT_CLI_CURVE_EVALUATION_H_
#define OVERTONE_CLIENT_CLI_CURVE_EVALUATION_H_

#include <string>

#include "absl/status/status.h"
#include "overtone/client/cli/client_flags.h"
#include "overtone/client/cli/evaluation_suite.h"

namespace overtone {

struct CurveEvaluation {
  std::string out;          // folder
  std::string data;         // folder of the recordings
  bool continuous = false;  // also play every strategy with a comparison every 20 s
  ClientFlags client;
};

// The server's map of each experiment is made once, by a replay without corrections; all strategies
// and budgets are then tried on what came of it. Writes <suite>.csv, .md and .svg after every
// experiment, so that one cut short leaves its first part.
absl::Status EvaluateCurves(const EvaluationSuite& suite, const CurveEvaluation& options);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_CURVE_EVALUATION_H_
