// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_CLIENT_INTERNAL_TRAFFIC_COUNTERS_H_
#define OVERTONE_CLIENT_INTERNAL_TRAFFIC_COUNTERS_H_

#include <atomic>
#include <cstdint>

namespace overtone {

// What went over the link, summed over all streams. Written by the streams' threads, read by
// anyone.
struct TrafficCounters {
  std::atomic<int64_t> bytes_sent{0};  // serialised messages, without HTTP/2 framing
  std::atomic<int64_t> bytes_received{0};
  std::atomic<int64_t> report_bytes_sent{0};  // of bytes_sent: status reports
  std::atomic<int64_t> reconnects{0};
};

}  // namespace overtone

#endif  // OVERTONE_CLIENT_INTERNAL_TRAFFIC_COUNTERS_H_
