// SPDX-License-Identifier: Apache-2.0
// How the command ends: 0 done; 1 it failed; 2 what it was given is wrong; 130 interrupted.
#ifndef OVERTONE_CLIENT_CLI_EXIT_CODE_H_
#define OVERTONE_CLIENT_CLI_EXIT_CODE_H_

#include "absl/status/status.h"
#include "absl/strings/string_view.h"

namespace overtone {

// The exit code for `status`, which is not ok, after saying on stderr what happened.
int Fail(absl::string_view command, const absl::Status& status);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_EXIT_CODE_H_
