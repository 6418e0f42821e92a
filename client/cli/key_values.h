// SPDX-License-Identifier: Apache-2.0
// Option values of the form "radius=1,sigma_t=0.03".
#ifndef OVERTONE_CLIENT_CLI_KEY_VALUES_H_
#define OVERTONE_CLIENT_CLI_KEY_VALUES_H_

#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"

namespace overtone {

// Sets each target whose key is in `text` to the number there. InvalidArgument names what is not
// "key=number", or a key that no target has.
absl::Status ParseKeyValues(absl::string_view text,
                            const std::vector<std::pair<std::string, double*>>& targets);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_KEY_VALUES_H_
