// SPDX-License-Identifier: Apache-2.0
// How far the robot's clock is ahead of the server's.
#ifndef OVERTONE_CLIENT_INTERNAL_CLOCK_OFFSET_H_
#define OVERTONE_CLIENT_INTERNAL_CLOCK_OFFSET_H_

#include <deque>
#include <optional>

#include "absl/time/time.h"

namespace overtone {

// A question and its answer bound the offset: the server read its clock somewhere in between, so
//     robot - server = sent + round_trip / 2 - server, +- round_trip / 2,
// whatever the two ways took. Of the last questions the one with the tightest bound counts, where
// an old one is widened by what clocks drift apart (Mills, RFC 5905, clock filter). One that
// contradicts it says that a clock was set: all before it is forgotten. Not thread-safe.
class ClockOffset {
 public:
  struct Estimate {
    absl::Duration offset;       // robot - server
    absl::Duration uncertainty;  // the offset is certainly within +- this
  };

  // `sent`: the robot's clock before the question. `round_trip`, by a clock that is never set.
  // `server`: its clock. `age_base`: steady time of the answer, for what has become old.
  void Add(absl::Time sent, absl::Duration round_trip, absl::Time server, absl::Duration age_base);

  // None: no answer yet. `now` as age_base.
  std::optional<Estimate> Get(absl::Duration now) const;

 private:
  struct Sample {
    absl::Duration offset;
    absl::Duration half_round_trip;
    absl::Duration at;
  };
  static absl::Duration Uncertainty(const Sample& sample, absl::Duration now);

  std::deque<Sample> samples_;  // the last few
};

// Which offsets are worth a word: one that is certainly above the limit, and then only what differs
// from the last word by more than the limit, or is back below it. Not thread-safe.
class ClockWarning {
 public:
  explicit ClockWarning(absl::Duration limit) : limit_(limit) {}

  enum class Word { kNone, kWarn, kBackToNormal };
  Word Judge(const ClockOffset::Estimate& estimate);

 private:
  const absl::Duration limit_;
  std::optional<absl::Duration> warned_;  // of this offset
};

}  // namespace overtone

#endif  // OVERTONE_CLIENT_INTERNAL_CLOCK_OFFSET_H_
