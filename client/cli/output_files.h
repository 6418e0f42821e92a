// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_CLIENT_CLI_OUTPUT_FILES_H_
#define OVERTONE_CLIENT_CLI_OUTPUT_FILES_H_

#include <string>

#include "absl/status/status.h"

namespace overtone {

// Makes the folder and what is above it. Unavailable, naming it, when that fails.
absl::Status MakeFolder(const std::string& path);

// Over what is there. Unavailable, naming it.
absl::Status WriteText(const std::string& path, const std::string& text);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_OUTPUT_FILES_H_
