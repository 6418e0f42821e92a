// SPDX-License-Identifier: Apache-2.0
// Suites over public recordings, in folders as docs/evaluation.md lists them.
#ifndef OVERTONE_CLIENT_CLI_RECORDED_SUITES_H_
#define OVERTONE_CLIENT_CLI_RECORDED_SUITES_H_

#include <vector>

#include "overtone/client/cli/evaluation_suite.h"

namespace overtone {

// One for each dataset, `constraints` (those with trajectories only: a minute) and `all` of them.
std::vector<EvaluationSuite> RecordedSuites();

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_RECORDED_SUITES_H_
