// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/exit_code.h"

#include <iostream>

namespace overtone {

int Fail(absl::string_view command, const absl::Status& status) {
  std::cerr << "overtone " << command << ": " << status.message() << "\n";
  switch (status.code()) {
    case absl::StatusCode::kInvalidArgument:
    case absl::StatusCode::kNotFound:
      return 2;
    case absl::StatusCode::kCancelled:
      return 130;
    default:
      return 1;
  }
}

}  // namespace overtone
