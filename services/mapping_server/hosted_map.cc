// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/hosted_map.h"

#include <utility>

#include "absl/time/clock.h"
#include "overtone/services/mapping_server/in_memory_submap_store.h"

namespace overtone {
namespace {

std::shared_ptr<const MapSnapshot> EmptySnapshot(uint64_t epoch) {
  MapSnapshot snapshot;
  snapshot.map_epoch = epoch;
  return std::make_shared<const MapSnapshot>(std::move(snapshot));
}

}  // namespace

HostedMap::HostedMap(std::string id, const ServerOptions& options)
    : id_(std::move(id)),
      epoch_(static_cast<uint64_t>(absl::ToUnixMicros(absl::Now()))),
      published_{EmptySnapshot(epoch_), absl::InfinitePast()},
      publisher_(id_, epoch_, options),
      pipeline_(options.map, epoch_, [this](std::shared_ptr<const MapSnapshot> snapshot) {
        OnSnapshot(std::move(snapshot));
      }) {
  SubmapStore::Sink sink;
  sink.on_submap = [this](const MissionId& mission, std::shared_ptr<const Submap> submap) {
    pipeline_.AddSubmap(mission, std::move(submap));
  };
  sink.on_loop_closure = [this](const LoopClosure& closure) { pipeline_.AddLoopClosure(closure); };
  sink.on_cloud = [this](const MissionId& mission, int64_t index, const std::string& sha256) {
    absl::StatusOr<SharedBlob> blob = store_->GetBlob(sha256);
    if (blob.ok()) pipeline_.AddCloud({mission, index}, *std::move(blob));
  };
  store_ = std::make_unique<InMemorySubmapStore>(options.limits, std::move(sink));
}

HostedMap::Published HostedMap::published() const {
  absl::MutexLock lock(&mutex_);
  return published_;
}

void HostedMap::OnSnapshot(std::shared_ptr<const MapSnapshot> snapshot) {
  {
    absl::MutexLock lock(&mutex_);
    published_ = {snapshot, absl::Now()};
  }
  publisher_.Publish(std::move(snapshot));
}

}  // namespace overtone
