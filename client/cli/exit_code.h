// SPDX-License-Identifier: Apache-2.0
// How the command ends. Scripts depend on these numbers: they are in --help and in the README.
#ifndef OVERTONE_CLIENT_CLI_EXIT_CODE_H_
#define OVERTONE_CLIENT_CLI_EXIT_CODE_H_

#include "absl/status/status.h"
#include "absl/strings/string_view.h"

namespace overtone {

enum ExitCode : int {
  kDone = 0,
  kFailed = 1,
  kWrongInput = 2,    // flags, files, ids; what is named is not there
  kUnreachable = 3,   // the server: not there, or it does not answer
  kRefused = 4,       // the server: by its access rules
  kInterrupted = 130  // Ctrl-C, SIGTERM
};

inline constexpr char kExitCodes[] =
    "Exit codes: 0 done; 1 failed; 2 wrong input (flags, files, names of what is not there); 3 the "
    "server\n"
    "cannot be reached or does not answer; 4 the server's access rules refuse it; 130 interrupted.";

// For `status`, whatever it is.
ExitCode ExitCodeOf(const absl::Status& status);

// The exit code for `status`, which is not ok, after saying on stderr what happened.
int Fail(absl::string_view command, const absl::Status& status);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_EXIT_CODE_H_
