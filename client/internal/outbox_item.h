// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_CLIENT_INTERNAL_OUTBOX_ITEM_H_
#define OVERTONE_CLIENT_INTERNAL_OUTBOX_ITEM_H_

#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace overtone {

using SharedBytes = std::shared_ptr<const std::string>;

// One thing that waits for the server.
struct OutboxItem {
  // Stored in files: never renumbered.
  enum class Kind { kSubmap = 1, kBlob = 2, kLoopClosures = 3 };

  int64_t id = 0;  // in order of arrival, never used twice in an outbox
  Kind kind = Kind::kSubmap;
  int64_t sequence = 0;     // of a submap, or of the submap that a blob belongs to
  int64_t first_index = 0;  // of a submap: its first keyframe
  std::string sha256;       // of a blob: its name on the wire
  int64_t size = 0;         // bytes
  SharedBytes bytes;        // null: only in the file
  bool saved = false;       // in the file

  // Of a submap, and only until it is saved: how the mission's position moves on with it.
  int64_t num_keyframes = 0;
  int64_t last_stamp_ns = 0;
};

// Where the mission goes on after all that was handed over.
struct OutboxPosition {
  int64_t next_sequence = 0;
  int64_t next_index = 0;
  int64_t last_stamp_ns = std::numeric_limits<int64_t>::min();  // none yet, or not known
  int64_t clouds_dropped = 0;                                   // of this mission so far

  bool operator==(const OutboxPosition& other) const {
    return next_sequence == other.next_sequence && next_index == other.next_index &&
           last_stamp_ns == other.last_stamp_ns && clouds_dropped == other.clouds_dropped;
  }
};

struct OutboxContent {
  std::vector<OutboxItem> items;  // by id, without bytes
  OutboxPosition position;
};

}  // namespace overtone

#endif  // OVERTONE_CLIENT_INTERNAL_OUTBOX_ITEM_H_
