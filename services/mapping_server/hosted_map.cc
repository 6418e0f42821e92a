// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/hosted_map.h"

#include <algorithm>
#include <utility>

#include "absl/time/clock.h"
#include "overtone/services/mapping_server/submap_store/sqlite_submap_store.h"

namespace overtone {
namespace {

constexpr size_t kKeptRevisions = 1000;

uint64_t NewEpoch() { return static_cast<uint64_t>(absl::ToUnixMicros(absl::Now())); }

std::shared_ptr<const MapSnapshot> EmptySnapshot() {
  MapSnapshot snapshot;
  snapshot.map_epoch = NewEpoch();
  return std::make_shared<const MapSnapshot>(std::move(snapshot));
}

}  // namespace

HostedMap::HostedMap(std::string id, const ServerOptions& options)
    : id_(std::move(id)),
      published_{EmptySnapshot(), absl::InfinitePast()},
      publisher_(id_, published_.snapshot->map_epoch, options),
      pipeline_(
          options.map, published_.snapshot->map_epoch,
          [this](std::shared_ptr<const MapSnapshot> snapshot, const RevisionRecord& what_changed) {
            OnSnapshot(std::move(snapshot), what_changed);
          }),
      detector_(options.loop_closures,
                {[this](LoopCandidate candidate) { pipeline_.AddCandidate(std::move(candidate)); },
                 [this](const ScoredCandidate& pair) { pipeline_.AddScoredCandidate(pair); },
                 [this](const MotionMeasurement& motion) { pipeline_.AddMotion(motion); }}) {
  SubmapStore::Sink sink;
  sink.on_submap = [this](const MissionId& mission, std::shared_ptr<const Submap> submap) {
    pipeline_.AddSubmap(mission, submap);
    detector_.AddSubmap(mission, *submap);
  };
  sink.on_loop_closure = [this](const LoopClosure& closure) { pipeline_.AddLoopClosure(closure); };
  sink.on_finding = [](const std::string&) {};
  sink.on_cloud = [this](const MissionId& mission, int64_t index, const std::string& sha256) {
    absl::StatusOr<SharedBlob> blob = store_->GetBlob(sha256);
    if (blob.ok()) detector_.AddCloud({mission, index}, *std::move(blob));
  };
  sink.on_cloud_gone = [this](const MissionId& mission, int64_t index) {
    detector_.CloudGone({mission, index});
  };
  store_ = *SqliteSubmapStore::Open(":memory:", options.limits, std::move(sink));
}

HostedMap::Published HostedMap::published() const {
  absl::MutexLock lock(&mutex_);
  return published_;
}

std::vector<HostedMap::PublishedRevision> HostedMap::revisions() const {
  absl::MutexLock lock(&mutex_);
  return {revisions_.begin(), revisions_.end()};
}

void HostedMap::Veto(const std::string& closure, Done done) {
  pipeline_.Decide([closure](MultiRobotMap& map) { return map.Veto(closure); }, std::move(done));
}

void HostedMap::Force(const std::string& closure, Done done) {
  pipeline_.Decide([closure](MultiRobotMap& map) { return map.Force(closure); }, std::move(done));
}

void HostedMap::RollBack(uint64_t revision,
                         std::function<void(const absl::StatusOr<RolledBack>&)> done) {
  auto result = std::make_shared<RolledBack>();
  pipeline_.Decide(
      [this, revision, result](MultiRobotMap& map) {
        result->map_epoch = std::max(NewEpoch(), epoch() + 1);
        const absl::StatusOr<int64_t> vetoed = map.RollBack(revision, result->map_epoch);
        if (vetoed.ok()) result->vetoed = *vetoed;
        return vetoed.status();
      },
      [result, done = std::move(done)](const absl::Status& status) {
        if (status.ok()) {
          done(*result);
        } else {
          done(status);
        }
      });
}

void HostedMap::OnSnapshot(std::shared_ptr<const MapSnapshot> snapshot,
                           const RevisionRecord& what_changed) {
  {
    absl::MutexLock lock(&mutex_);
    published_ = {snapshot, absl::Now()};
    revisions_.push_front({what_changed, published_.time});
    if (revisions_.size() > kKeptRevisions) revisions_.pop_back();
  }
  publisher_.Publish(std::move(snapshot));
}

}  // namespace overtone
