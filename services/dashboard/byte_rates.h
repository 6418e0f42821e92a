// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_SERVICES_DASHBOARD_BYTE_RATES_H_
#define OVERTONE_SERVICES_DASHBOARD_BYTE_RATES_H_

#include <cstdint>
#include <deque>
#include <map>
#include <string>

#include "absl/time/time.h"

namespace overtone {

// Turns counters that only grow, or start anew when the server does, into rates over a window.
class ByteRates {
 public:
  explicit ByteRates(absl::Duration window) : window_(window) {}

  // Per second, between the oldest sample within the window and this one; 0 for the first.
  double Add(const std::string& counter, absl::Time time, int64_t bytes);

 private:
  struct Sample {
    absl::Time time;
    int64_t bytes;
  };
  const absl::Duration window_;
  std::map<std::string, std::deque<Sample>> samples_;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_DASHBOARD_BYTE_RATES_H_
