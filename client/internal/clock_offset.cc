// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/internal/clock_offset.h"

#include <algorithm>

namespace overtone {
namespace {

constexpr size_t kMaxSamples = 8;
constexpr double kMaxDrift = 1e-4;  // two bad quartzes, 50 ppm each

}  // namespace

absl::Duration ClockOffset::Uncertainty(const Sample& sample, absl::Duration now) {
  return sample.half_round_trip + kMaxDrift * (now - sample.at);
}

void ClockOffset::Add(absl::Time sent, absl::Duration round_trip, absl::Time server,
                      absl::Duration age_base) {
  const Sample sample{sent + round_trip / 2 - server, round_trip / 2, age_base};
  const std::optional<Estimate> before = Get(age_base);
  if (before && absl::AbsDuration(sample.offset - before->offset) >
                    sample.half_round_trip + before->uncertainty) {
    samples_.clear();
  }
  samples_.push_back(sample);
  if (samples_.size() > kMaxSamples) samples_.pop_front();
}

std::optional<ClockOffset::Estimate> ClockOffset::Get(absl::Duration now) const {
  if (samples_.empty()) return std::nullopt;
  const auto best =
      std::min_element(samples_.begin(), samples_.end(), [now](const Sample& a, const Sample& b) {
        return Uncertainty(a, now) < Uncertainty(b, now);
      });
  return Estimate{best->offset, Uncertainty(*best, now)};
}

ClockWarning::Word ClockWarning::Judge(const ClockOffset::Estimate& estimate) {
  const absl::Duration certain = absl::AbsDuration(estimate.offset) - estimate.uncertainty;
  if (certain <= limit_) {
    const bool possible = absl::AbsDuration(estimate.offset) + estimate.uncertainty <= limit_;
    if (!warned_ || !possible) return Word::kNone;
    warned_ = std::nullopt;
    return Word::kBackToNormal;
  }
  if (warned_ && absl::AbsDuration(estimate.offset - *warned_) <= limit_) return Word::kNone;
  warned_ = estimate.offset;
  return Word::kWarn;
}

}  // namespace overtone
