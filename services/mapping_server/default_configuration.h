// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_DEFAULT_CONFIGURATION_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_DEFAULT_CONFIGURATION_H_

#include "absl/strings/string_view.h"

namespace overtone {

// configs/default.yaml, compiled in.
absl::string_view DefaultConfiguration();

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_DEFAULT_CONFIGURATION_H_
