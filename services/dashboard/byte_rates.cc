// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/dashboard/byte_rates.h"

namespace overtone {

double ByteRates::Add(const std::string& counter, absl::Time time, int64_t bytes) {
  std::deque<Sample>& samples = samples_[counter];
  if (!samples.empty() && bytes < samples.back().bytes) samples.clear();  // it started anew
  // One older than the window stays: else a rate would be of less than the window.
  while (samples.size() > 1 && samples[1].time <= time - window_) samples.pop_front();
  samples.push_back({time, bytes});
  const double seconds = absl::ToDoubleSeconds(time - samples.front().time);
  return seconds > 0 ? static_cast<double>(bytes - samples.front().bytes) / seconds : 0;
}

}  // namespace overtone
