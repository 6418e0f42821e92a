// SPDX-License-Identifier: Apache-2.0
// Which clouds wait for their blobs, and which of these are still asked for. Without blobs or
// locks, so that every store applies the same rules.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_CLOUD_LEDGER_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_CLOUD_LEDGER_H_

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/types/optional.h"
#include "overtone/core/common/ids.h"
#include "overtone/core/graph/submap.h"
#include "overtone/services/mapping_server/submap_store.h"

namespace overtone {

// Not thread-safe.
class CloudLedger {
 public:
  // A cloud of a stored submap whose blob is not there: it waits, and its mission is asked.
  void Await(const MissionId& mission, const KeyframeCloud& cloud);

  bool IsAwaited(const std::string& sha256) const { return awaiting_.contains(sha256); }

  // The blob came: the keyframes that waited for it, in the order of Await.
  std::vector<NodeId> Resolve(const std::string& sha256);

  // The mission is asked no more; its clouds go on waiting. Those that it was asked for until now.
  std::vector<NodeId> Abandon(const MissionId& mission, const std::string& sha256);

  // The mission is deleted: nothing of it waits any more.
  void Forget(const MissionId& mission);

  // A mission whose cloud waits for this blob.
  absl::optional<MissionId> FirstWaiting(const std::string& sha256) const;

  // The first `max` that the mission is asked for, each once, by keyframe.
  std::vector<MissingBlob> Missing(const MissionId& mission, size_t max) const;

  // Clouds whose mission is asked.
  int64_t NumMissing(const MissionId& mission) const;
  int64_t NumMissing() const { return num_missing_; }

 private:
  // False: nobody was asked.
  bool StopAsking(const NodeId& keyframe);

  std::map<MissionId, std::map<int64_t, MissingBlob>> asked_;  // by keyframe index
  absl::flat_hash_map<std::string, std::vector<NodeId>> awaiting_;
  int64_t num_missing_ = 0;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_CLOUD_LEDGER_H_
