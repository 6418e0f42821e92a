// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_CLIENT_INTERNAL_SUBMAP_SEQUENCE_H_
#define OVERTONE_CLIENT_INTERNAL_SUBMAP_SEQUENCE_H_

#include <cstdint>
#include <limits>

#include "absl/status/status.h"
#include "overtone/client/internal/outbox_item.h"
#include "overtone/core/common/timestamp.h"
#include "overtone/core/graph/submap.h"

namespace overtone {

// Which submap of the mission comes next. Not thread-safe.
class SubmapSequence {
 public:
  // Ok when `submap` (valid in itself) continues the mission.
  // OutOfRange: not the next sequence or index. InvalidArgument: time does not go on.
  absl::Status Check(const Submap& submap) const;

  // `submap` was taken.
  void Advance(const Submap& submap);

  // Goes on at another place. Without a last stamp, whether the next ones follow what went before
  // is left to the server.
  void MoveTo(const OutboxPosition& position);

  int64_t sequence() const { return sequence_; }
  int64_t first_index() const { return first_index_; }

 private:
  int64_t sequence_ = 0;
  int64_t first_index_ = 0;
  Timestamp last_stamp_{std::numeric_limits<int64_t>::min()};
};

}  // namespace overtone

#endif  // OVERTONE_CLIENT_INTERNAL_SUBMAP_SEQUENCE_H_
