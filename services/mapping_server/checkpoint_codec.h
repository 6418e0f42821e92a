// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_CHECKPOINT_CODEC_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_CHECKPOINT_CODEC_H_

#include <cstdint>
#include <string>

#include "absl/status/statusor.h"
#include "overtone/core/mapping/map_checkpoint.h"

namespace overtone {

// What the store keeps of a map beside its log.
struct StoredCheckpoint {
  MapCheckpoint map;
  int64_t entries = 0;  // of the log, that it takes into account
  // Somebody may know of revisions up to this one: who goes on from here starts after it.
  uint64_t reserved_through_revision = 0;
};

// 56 bytes a keyframe and some 60 a closure. The poses come back bit by bit.
std::string ToBytes(const StoredCheckpoint& checkpoint);
// DataLoss: ToBytes did not make it.
absl::StatusOr<StoredCheckpoint> ParseCheckpoint(const std::string& bytes);

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_CHECKPOINT_CODEC_H_
