// SPDX-License-Identifier: Apache-2.0
// Counts what was observed, by size. Observing costs a few atomic additions.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_METRICS_HISTOGRAM_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_METRICS_HISTOGRAM_H_

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace overtone {

// Thread-safe. Bounds are upper ones, increasing, included; there is one more bucket for what lies
// beyond the last.
template <size_t kBounds>
class Histogram {
 public:
  explicit Histogram(const std::array<double, kBounds>& bounds) : bounds_(bounds) {}

  void Observe(double value) {
    const auto bucket = std::lower_bound(bounds_.begin(), bounds_.end(), value) - bounds_.begin();
    counts_[static_cast<size_t>(bucket)].fetch_add(1, std::memory_order_relaxed);
    double sum = sum_.load(std::memory_order_relaxed);
    while (!sum_.compare_exchange_weak(sum, sum + value, std::memory_order_relaxed)) {
    }
  }

  const std::array<double, kBounds>& bounds() const { return bounds_; }
  // Of each bucket alone, the last one's included. Observations meanwhile may show in one of
  // Counts and Sum only.
  std::vector<uint64_t> Counts() const {
    return std::vector<uint64_t>(counts_.begin(), counts_.end());
  }
  double Sum() const { return sum_.load(std::memory_order_relaxed); }

 private:
  const std::array<double, kBounds> bounds_;
  std::array<std::atomic<uint64_t>, kBounds + 1> counts_{};
  std::atomic<double> sum_{0};
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_METRICS_HISTOGRAM_H_
