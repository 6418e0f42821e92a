// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_CORE_SIMULATION_OPTION_RANGE_H_
#define OVERTONE_CORE_SIMULATION_OPTION_RANGE_H_

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"

namespace overtone {

// Says which member of which struct is out of range.
class OptionRange {
 public:
  explicit OptionRange(const char* options) : options_(options) {}

  // InvalidArgument unless low <= value <= high; NaN is out of every range.
  absl::Status Check(const char* member, double value, double low, double high) const {
    if (value >= low && value <= high) return absl::OkStatus();
    return absl::InvalidArgumentError(
        absl::StrCat(options_, ".", member, ": must be from ", low, " to ", high, ", is ", value));
  }

 private:
  const char* options_;
};

}  // namespace overtone

#endif  // OVERTONE_CORE_SIMULATION_OPTION_RANGE_H_
