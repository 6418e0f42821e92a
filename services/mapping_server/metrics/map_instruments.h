// SPDX-License-Identifier: Apache-2.0
// What the parts of one map count while they work, for /metrics. They go with the map.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_METRICS_MAP_INSTRUMENTS_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_METRICS_MAP_INSTRUMENTS_H_

#include <array>
#include <atomic>
#include <cstdint>

#include "overtone/services/mapping_server/metrics/histogram.h"

namespace overtone {

// From a cycle over a small map to one that takes minutes.
constexpr std::array<double, 12> kCycleBoundsS = {0.001, 0.003, 0.01, 0.03, 0.1, 0.3,
                                                  1,     3,     10,   30,   100, 300};
// A transaction with its fsync: a good SSD, a bad SD card, a disk that hangs.
constexpr std::array<double, 12> kCommitBoundsS = {0.0005, 0.001, 0.0025, 0.005, 0.01, 0.025,
                                                   0.05,   0.1,   0.25,   1,     5,    30};
constexpr std::array<double, 8> kEntriesBounds = {1, 2, 4, 8, 16, 32, 64, 128};

// Written by the store's own thread.
struct StoreInstruments {
  Histogram<12> commit_s{kCommitBoundsS};
  Histogram<8> commit_entries{kEntriesBounds};
  std::atomic<int64_t> errors{0};  // batches of which nothing could be stored
};

// The parts of a mapping cycle (StageTime in map_admin_service.proto), seconds.
struct CycleTimes {
  double intake_s = 0;
  double optimise_s = 0;
  double snapshot_s = 0;
  double store_s = 0;
  double publish_s = 0;
};
constexpr std::array<const char*, 5> kStageNames = {"intake", "optimise", "snapshot", "store",
                                                    "publish"};
inline std::array<double, 5> Seconds(const CycleTimes& times) {
  return {times.intake_s, times.optimise_s, times.snapshot_s, times.store_s, times.publish_s};
}

struct MapInstruments {
  StoreInstruments store;
  std::array<Histogram<12>, 5> stage_s{Histogram<12>(kCycleBoundsS), Histogram<12>(kCycleBoundsS),
                                       Histogram<12>(kCycleBoundsS), Histogram<12>(kCycleBoundsS),
                                       Histogram<12>(kCycleBoundsS)};
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_METRICS_MAP_INSTRUMENTS_H_
