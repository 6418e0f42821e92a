// SPDX-License-Identifier: Apache-2.0
// Named points at which a test kills the process: with OVERTONE_FAILPOINT=name:count in the
// environment it sends itself SIGKILL when it passes that point for the count-th time. The
// environment is read once, before main; nothing that a peer sends can set it.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_FAILPOINT_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_FAILPOINT_H_

#include "absl/strings/string_view.h"

namespace overtone {
namespace failpoint_internal {

extern const bool armed;
void Pass(absl::string_view name);

}  // namespace failpoint_internal

// Thread-safe. Costs one load when none is set.
inline void Failpoint(absl::string_view name) {
  if (failpoint_internal::armed) failpoint_internal::Pass(name);
}

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_FAILPOINT_H_
