// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/exit_code.h"

#include <iostream>

#include "overtone/client/cli/server_error.h"

namespace overtone {

ExitCode ExitCodeOf(const absl::Status& status) {
  switch (status.code()) {
    case absl::StatusCode::kOk:
      return kDone;
    case absl::StatusCode::kInvalidArgument:
    case absl::StatusCode::kNotFound:
      return kWrongInput;
    case absl::StatusCode::kCancelled:
      return kInterrupted;
    case absl::StatusCode::kUnavailable:
    case absl::StatusCode::kDeadlineExceeded:  // of a disk or a child process, too
      return IsFromServer(status) ? kUnreachable : kFailed;
    case absl::StatusCode::kPermissionDenied:
    case absl::StatusCode::kUnauthenticated:
      return kRefused;
    default:
      return kFailed;
  }
}

int Fail(absl::string_view command, const absl::Status& status) {
  std::cerr << "overtone " << command << ": " << status.message() << "\n";
  return ExitCodeOf(status);
}

}  // namespace overtone
