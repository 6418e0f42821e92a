// SPDX-License-Identifier: Apache-2.0
// The main job: a team's recordings go through the real client, the real RPCs and a real server, in
// step in data time.
#ifndef OVERTONE_CLIENT_CLI_REPLAY_H_
#define OVERTONE_CLIENT_CLI_REPLAY_H_

#include "absl/status/statusor.h"
#include "overtone/client/cli/replay_options.h"
#include "overtone/client/cli/run_result.h"

namespace overtone {

// Step by step: every robot uploads what it saw; the server maps all of it; every robot compares
// and corrects. Nothing is compared with a map that lacks data of that step, so that a run does not
// depend on how fast the machine is. Progress goes to stderr, the recordings and the server's log
// to options.out. All processes that it starts have ended when it returns.
absl::StatusOr<RunResult> RunReplay(const ReplayOptions& options);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_REPLAY_H_
