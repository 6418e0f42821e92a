// SPDX-License-Identifier: Apache-2.0
// From a replay's options to the recordings of its robots.
#ifndef OVERTONE_CLIENT_CLI_LOAD_RECORDINGS_H_
#define OVERTONE_CLIENT_CLI_LOAD_RECORDINGS_H_

#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "overtone/client/cli/drift_injection.h"
#include "overtone/client/cli/replay_options.h"

namespace overtone {

struct LoadedRecordings {
  std::vector<Recording> recordings;
  std::optional<DriftInjection> drift;  // that is in their odometry
};

// Reads or simulates, aligns, cuts, injects drift. Errors name the option or the file and line.
absl::StatusOr<LoadedRecordings> LoadRecordings(const ReplayOptions& options);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_LOAD_RECORDINGS_H_
