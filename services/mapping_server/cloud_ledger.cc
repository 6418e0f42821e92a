// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/cloud_ledger.h"

#include <algorithm>
#include <utility>

#include "absl/container/flat_hash_set.h"

namespace overtone {

void CloudLedger::Await(const MissionId& mission, const KeyframeCloud& cloud) {
  awaiting_[cloud.sha256].push_back({mission, cloud.index});
  asked_[mission][cloud.index] = {cloud.sha256, cloud.encoded_bytes};
  ++num_missing_;
}

std::vector<NodeId> CloudLedger::Resolve(const std::string& sha256) {
  const auto it = awaiting_.find(sha256);
  if (it == awaiting_.end()) return {};
  std::vector<NodeId> keyframes = std::move(it->second);
  awaiting_.erase(it);
  for (const NodeId& keyframe : keyframes) StopAsking(keyframe);
  return keyframes;
}

std::vector<NodeId> CloudLedger::Abandon(const MissionId& mission, const std::string& sha256) {
  std::vector<NodeId> abandoned;
  const auto it = awaiting_.find(sha256);
  if (it == awaiting_.end()) return abandoned;
  for (const NodeId& keyframe : it->second) {
    if (keyframe.mission == mission && StopAsking(keyframe)) abandoned.push_back(keyframe);
  }
  return abandoned;
}

void CloudLedger::Forget(const MissionId& mission) {
  for (auto it = awaiting_.begin(); it != awaiting_.end();) {
    std::vector<NodeId>& keyframes = it->second;
    keyframes.erase(std::remove_if(keyframes.begin(), keyframes.end(),
                                   [&](const NodeId& node) { return node.mission == mission; }),
                    keyframes.end());
    if (keyframes.empty()) {
      awaiting_.erase(it++);
    } else {
      ++it;
    }
  }
  num_missing_ -= NumMissing(mission);
  asked_.erase(mission);
}

absl::optional<MissionId> CloudLedger::FirstWaiting(const std::string& sha256) const {
  const auto it = awaiting_.find(sha256);
  if (it == awaiting_.end() || it->second.empty()) return absl::nullopt;
  return it->second.front().mission;
}

bool CloudLedger::StopAsking(const NodeId& keyframe) {
  const auto it = asked_.find(keyframe.mission);
  if (it == asked_.end() || it->second.erase(keyframe.index) == 0) return false;
  --num_missing_;
  if (it->second.empty()) asked_.erase(it);
  return true;
}

std::vector<MissingBlob> CloudLedger::Missing(const MissionId& mission, size_t max) const {
  std::vector<MissingBlob> missing;
  const auto it = asked_.find(mission);
  if (it == asked_.end()) return missing;
  absl::flat_hash_set<std::string> seen;
  for (const auto& [index, blob] : it->second) {
    if (missing.size() >= max) break;
    if (seen.insert(blob.sha256).second) missing.push_back(blob);
  }
  return missing;
}

int64_t CloudLedger::NumMissing(const MissionId& mission) const {
  const auto it = asked_.find(mission);
  return it == asked_.end() ? 0 : static_cast<int64_t>(it->second.size());
}

}  // namespace overtone
