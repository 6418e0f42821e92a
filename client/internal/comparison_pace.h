// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_CLIENT_INTERNAL_COMPARISON_PACE_H_
#define OVERTONE_CLIENT_INTERNAL_COMPARISON_PACE_H_

#include <algorithm>

#include "absl/time/time.h"

namespace overtone {

// How long to compare nothing after a comparison that took so long: `shortest`, and enough for
// comparisons to take no more than a tenth of a core, however often the map changes.
inline absl::Duration PauseAfterComparison(absl::Duration took, absl::Duration shortest) {
  return std::max(shortest, 9 * took);
}

}  // namespace overtone

#endif  // OVERTONE_CLIENT_INTERNAL_COMPARISON_PACE_H_
