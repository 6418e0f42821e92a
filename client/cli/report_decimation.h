// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_CLIENT_CLI_REPORT_DECIMATION_H_
#define OVERTONE_CLIENT_CLI_REPORT_DECIMATION_H_

#include <cstdint>
#include <vector>

namespace overtone {

// At most max_count (> 1) of the positions 0..count-1, evenly spread, first and last among them.
inline std::vector<int> EvenlySpread(int64_t count, int64_t max_count) {
  std::vector<int> positions;
  const int64_t kept = count < max_count ? count : max_count;
  for (int64_t i = 0; i < kept; ++i) {
    positions.push_back(kept == 1 ? 0 : static_cast<int>(i * (count - 1) / (kept - 1)));
  }
  return positions;
}

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_REPORT_DECIMATION_H_
