// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/hosted_map.h"

#include <algorithm>
#include <array>
#include <utility>
#include <variant>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/status_conversion.h"
#include "overtone/services/mapping_server/checkpoint_codec.h"
#include "overtone/services/mapping_server/log_fields.h"
#include "overtone/services/mapping_server/log_limit.h"
#include "overtone/services/mapping_server/submap_store/sqlite_submap_store.h"

namespace overtone {
namespace {

constexpr size_t kKeptRevisions = 1000;

uint64_t NewEpoch() { return static_cast<uint64_t>(absl::ToUnixMicros(absl::Now())); }

absl::optional<StoredCheckpoint> ReadCheckpoint(const SubmapStore& store, const std::string& map) {
  const absl::StatusOr<std::string> bytes = store.GetSnapshot();
  if (!bytes.ok()) return absl::nullopt;
  absl::StatusOr<StoredCheckpoint> checkpoint = ParseCheckpoint(*bytes);
  if (checkpoint.ok()) return *std::move(checkpoint);
  spdlog::error("map {}: its checkpoint cannot be read: {}", map, checkpoint.status().ToString());
  return absl::nullopt;
}

}  // namespace

absl::StatusOr<std::unique_ptr<HostedMap>> HostedMap::Open(std::string id, std::string path,
                                                           const ServerOptions& options,
                                                           Epoch epoch) {
  const LogFields about = LogFieldsOf(id);
  const LogScope scope(&about);
  std::unique_ptr<HostedMap> map(new HostedMap(std::move(id), std::move(path), options));
  RETURN_IF_ERROR(map->Start(epoch));
  return map;
}

absl::Status HostedMap::Start(Epoch epoch) {
  StoreOptions store_options;
  store_options.instruments = &instruments_.store;
  store_options.map = id_;
  ASSIGN_OR_RETURN(store_,
                   SqliteSubmapStore::Open(path_, options_.limits, StoreSink(), store_options));
  MappingPipeline::Sink sink;
  sink.publish = [this](std::shared_ptr<const MapSnapshot> snapshot,
                        const RevisionHistory& history) {
    OnSnapshot(std::move(snapshot), history);
  };
  sink.store = [this](std::string bytes, Done done) {
    store_->PutSnapshot(std::move(bytes), std::move(done));
  };
  sink.timed = [this](uint64_t revision, const CycleTimes& times) { OnTimed(revision, times); };
  sink.map = id_;
  pipeline_ = std::make_unique<MappingPipeline>(options_.map, std::move(sink));
  detector_ = std::make_unique<LoopDetector>(
      options_.loop_closures, [this](const std::string& sha256) { return store_->GetBlob(sha256); },
      DetectorSink());
  RETURN_IF_ERROR(Replay(epoch));

  auto empty = std::make_shared<MapSnapshot>();
  empty->map_epoch = replayed_.map_epoch;
  {
    absl::MutexLock lock(&mutex_);
    published_ = {empty, absl::InfinitePast()};
  }
  publisher_ = std::make_unique<GraphPublisher>(id_, empty->map_epoch, options_);
  absl::optional<StoredCheckpoint> checkpoint = ReadCheckpoint(*store_, id_);
  if (checkpoint.has_value()) checkpoint->map.decisions.map_epoch = replayed_.map_epoch;
  pipeline_->Start(checkpoint);
  detector_->EndReplay();
  return absl::OkStatus();
}

absl::Status HostedMap::Replay(Epoch epoch) {
  detector_->BeginReplay();
  replaying_ = true;
  RETURN_IF_ERROR(store_->Replay());
  if (replayed_.map_epoch == 0 || epoch == Epoch::kNew) {
    // The epoch is in the log from the beginning, and what operators said stays said.
    StoreFinding(MapDecisions{NewEpoch(), replayed_.decisions});
    store_->Drain();
    if (replayed_.map_epoch == 0) return absl::ResourceExhaustedError("map: nothing can be stored");
  }
  replaying_ = false;
  return absl::OkStatus();
}

HostedMap::~HostedMap() {
  if (store_ == nullptr) return;  // never opened
  store_->Drain();                // calls the detector no more: nobody else appends now
  detector_.reset();
  store_->Drain();  // what it found
  pipeline_.reset();
}

SubmapStore::Sink HostedMap::StoreSink() {
  SubmapStore::Sink sink;
  sink.on_submap = [this](const MissionId& mission, std::shared_ptr<const Submap> submap) {
    pipeline_->AddSubmap(mission, submap);
    detector_->AddSubmap(mission, *submap);
  };
  sink.on_loop_closure = [this](const LoopClosure& closure) { pipeline_->AddLoopClosure(closure); };
  sink.on_finding = [this](const std::string& bytes) { OnFinding(bytes); };
  sink.on_cloud = [this](const MissionId& mission, int64_t index, const std::string& sha256) {
    detector_->AddCloud({mission, index}, sha256);
  };
  sink.on_cloud_gone = [this](const MissionId& mission, int64_t index) {
    detector_->CloudGone({mission, index});
  };
  return sink;
}

LoopDetector::Sink HostedMap::DetectorSink() {
  const auto store = [this](auto found) { StoreFinding(std::move(found)); };
  return {store, store, store, store};
}

void HostedMap::OnFinding(const std::string& bytes) {
  absl::StatusOr<Finding> finding = ParseFinding(bytes);
  if (!finding.ok()) {
    // It keeps its place in the log, of which checkpoints count the entries.
    spdlog::error("map {}: {}", id_, finding.status().ToString());
    finding = SearchResult();
  }
  if (replaying_) NoteForDetector(*finding);
  pipeline_->AddFinding(*std::move(finding));
}

void HostedMap::NoteForDetector(const Finding& finding) {
  if (const auto* search = std::get_if<SearchResult>(&finding)) {
    detector_->NoteSearch(search->node);
  } else if (const auto* motion = std::get_if<RefinedMotion>(&finding)) {
    detector_->NoteMotion(*motion);
  } else if (const auto* pair = std::get_if<ScoredCandidate>(&finding)) {
    detector_->NotePair(pair->from, pair->to);
  } else if (const auto* candidate = std::get_if<LoopCandidate>(&finding)) {
    detector_->NotePair(candidate->from, candidate->to);
  } else if (const auto* decisions = std::get_if<MapDecisions>(&finding)) {
    replayed_ = *decisions;
  }
}

// A finding that cannot be stored is looked for again after a restart, and missing until then.
void HostedMap::StoreFinding(const Finding& finding) {
  store_->AppendFinding(ToRecord(finding), [this](const absl::Status& status) {
    if (status.ok()) return;
    LogPeer(spdlog::level::warn, "finding lost", "map {}: a finding is lost: {}", id_,
            HeaderSafe(status.ToString()));
  });
}

HostedMap::Published HostedMap::published() const {
  absl::MutexLock lock(&mutex_);
  return published_;
}

std::vector<HostedMap::KeptRevision> HostedMap::revisions() const {
  absl::MutexLock lock(&mutex_);
  return {revisions_.begin(), revisions_.end()};
}

void HostedMap::Decide(MappingPipeline::Decision decision, Done done) {
  auto standing = std::make_shared<MapDecisions>();
  pipeline_->Decide(
      [decision = std::move(decision), standing](MultiRobotMap& map) {
        const absl::Status status = decision(map);
        *standing = map.Decisions();
        return status;
      },
      [this, standing, done = std::move(done)](const absl::Status& status) {
        if (!status.ok()) return done(status);
        store_->AppendFinding(ToRecord(*standing), [done](const absl::Status& stored) {
          if (stored.ok()) return done(stored);
          done(absl::Status(stored.code(),
                            absl::StrCat("in effect, but not stored: ", stored.message())));
        });
      });
}

void HostedMap::Veto(const std::string& closure, Done done) {
  Decide([closure](MultiRobotMap& map) { return map.Veto(closure); }, std::move(done));
}

void HostedMap::Force(const std::string& closure, Done done) {
  Decide([closure](MultiRobotMap& map) { return map.Force(closure); }, std::move(done));
}

void HostedMap::RollBack(uint64_t revision,
                         std::function<void(const absl::StatusOr<RolledBack>&)> done) {
  auto result = std::make_shared<RolledBack>();
  Decide(
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
                           const RevisionHistory& history) {
  {
    absl::MutexLock lock(&mutex_);
    if (revisions_.empty()) {  // the first, or those from before a restart
      const auto& records = history.records();
      for (auto it = records.rbegin(); it != records.rend(); ++it) revisions_.push_back({*it, {}});
    } else {
      revisions_.push_front({history.records().back(), {}});
    }
    if (revisions_.size() > kKeptRevisions) revisions_.pop_back();
    published_ = {snapshot, revisions_.front().record.made};
  }
  publisher_->Publish(std::move(snapshot));
}

void HostedMap::OnTimed(uint64_t revision, const CycleTimes& times) {
  const std::array<double, 5> seconds = Seconds(times);
  for (size_t i = 0; i < seconds.size(); ++i) instruments_.stage_s[i].Observe(seconds[i]);
  absl::MutexLock lock(&mutex_);
  if (!revisions_.empty() && revisions_.front().record.revision == revision) {
    revisions_.front().times = times;
  }
}

}  // namespace overtone
