// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/mapping/map_snapshot.h"

namespace overtone {

absl::string_view ToString(ClosureVerdict verdict) {
  switch (verdict) {
    case ClosureVerdict::kPending:
      return "pending";
    case ClosureVerdict::kAccepted:
      return "accepted";
    case ClosureVerdict::kDemotedByOptimiser:
      return "demoted_by_optimiser";
  }
  return "unknown";
}

}  // namespace overtone
