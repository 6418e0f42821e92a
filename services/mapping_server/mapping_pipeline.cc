// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/mapping_pipeline.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <utility>
#include <variant>

#include "absl/time/clock.h"
#include "overtone/proto/conversion/status_conversion.h"
#include "overtone/services/mapping_server/background_thread.h"
#include "overtone/services/mapping_server/log_fields.h"
#include "overtone/services/mapping_server/log_limit.h"

namespace overtone {
namespace {

// A candidate after the other comes out of the front end: a revision for each would be mostly
// overhead, and nobody can use ten a second.
constexpr absl::Duration kMinInterval = absl::Milliseconds(100);

// Between two checkpoints; and making one may take this share of the thread's time.
constexpr absl::Duration kMinCheckpointInterval = absl::Seconds(1);
constexpr double kCheckpointShare = 0.05;
// Revisions that a checkpoint gives away: as many as come in a day, should no other be stored.
constexpr uint64_t kReservedRevisions = 1'000'000;
// For a disk that has stopped answering; the map goes on without.
constexpr absl::Duration kStoreTimeout = absl::Seconds(5);

class Stopwatch {
 public:
  // Seconds since the lap before.
  double Lap() {
    const Clock::time_point now = Clock::now();
    return std::chrono::duration<double>(now - std::exchange(last_, now)).count();
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point last_ = Clock::now();
};

// What was found at one keyframe. All of it, even when some is refused.
absl::Status Add(const SearchResult& search, MultiRobotMap& map) {
  absl::Status status;
  for (const LoopCandidate& candidate : search.candidates) {
    status.Update(map.AddCandidate(candidate));
  }
  return status;
}
absl::Status Add(const ScoredCandidate& pair, MultiRobotMap& map) {
  return map.AddScoredCandidate(pair);
}
absl::Status Add(const LoopCandidate& candidate, MultiRobotMap& map) {
  return map.AddCandidate(candidate);
}
absl::Status Add(const RefinedMotion& motion, MultiRobotMap& map) {
  return map.AddMotion(motion.measurement);
}
absl::Status Add(const MapDecisions& decisions, MultiRobotMap& map) {
  map.SetDecisions(decisions);
  return absl::OkStatus();
}

}  // namespace

MappingPipeline::MappingPipeline(const MultiRobotMapOptions& options, Sink sink)
    : sink_(std::move(sink)), map_(options) {}

MappingPipeline::~MappingPipeline() {
  bool started = false;
  {
    absl::MutexLock lock(&mutex_);
    stopping_ = true;
    give_up_ = true;
    started = started_;
  }
  if (started) {
    thread_.join();
    if (map_.revision() > 0 && !map_.dirty()) StoreCheckpointAndWait(map_.revision());
  }
  absl::MutexLock lock(&mutex_);
  for (const Work& work : work_) {
    if (work.done != nullptr) work.done(absl::UnavailableError("the server is shutting down"));
  }
  // Their answers refer to us.
  const auto none_under_way = [this]() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    return checkpoints_under_way_ == 0;
  };
  mutex_.Await(absl::Condition(&none_under_way));
}

void MappingPipeline::AddSubmap(const MissionId& mission, std::shared_ptr<const Submap> submap) {
  Enqueue([mission, submap = std::move(submap)](MultiRobotMap& map) {
    return map.AddSubmap(mission, *submap);
  });
}

void MappingPipeline::AddLoopClosure(const LoopClosure& closure) {
  Enqueue([closure](MultiRobotMap& map) { return map.AddLoopClosure(closure); });
}

void MappingPipeline::AddFinding(Finding finding) {
  const bool in_effect = [&] {
    absl::MutexLock lock(&mutex_);
    return started_ && std::holds_alternative<MapDecisions>(finding);
  }();
  if (in_effect) return Enqueue([](MultiRobotMap&) { return absl::OkStatus(); });
  Enqueue([finding = std::move(finding)](MultiRobotMap& map) {
    return std::visit([&](const auto& value) { return Add(value, map); }, finding);
  });
}

void MappingPipeline::Decide(Decision decision, std::function<void(const absl::Status&)> done) {
  {
    absl::MutexLock lock(&mutex_);
    if (!stopping_) {
      work_.push_back({std::move(decision), std::move(done)});
      return;
    }
  }
  done(absl::UnavailableError("the server is shutting down"));
}

int64_t MappingPipeline::backlog() const {
  absl::MutexLock lock(&mutex_);
  return static_cast<int64_t>(work_.size()) + in_hand_;
}

void MappingPipeline::Enqueue(Decision apply) {
  absl::MutexLock lock(&mutex_);
  work_.push_back({std::move(apply), nullptr});
}

void MappingPipeline::Start(const absl::optional<StoredCheckpoint>& checkpoint) {
  std::vector<Work> log;
  {
    absl::MutexLock lock(&mutex_);
    log = std::exchange(work_, {});
  }
  const auto size = static_cast<int64_t>(log.size());
  const int64_t covered =
      checkpoint.has_value() ? std::clamp<int64_t>(checkpoint->entries, 0, size) : 0;
  for (int64_t k = 0; k < covered; ++k) Apply(log[k]);
  const bool restored = covered > 0 && Restore(*checkpoint);
  for (int64_t k = covered; k < size; ++k) Apply(log[k]);
  if (!restored && checkpoint.has_value()) {
    // With what it says of epoch and revisions it is still right.
    map_.StartAfter(checkpoint->reserved_through_revision);
  } else if (!checkpoint.has_value() && map_.dirty()) {
    map_.StartAfter(kReservedRevisions);  // the process ended before the first was stored
  }
  absl::MutexLock lock(&mutex_);
  in_hand_ = map_.dirty() ? 1 : 0;  // what the checkpoint does not take into account
  started_ = true;
  thread_ = std::thread([this] {
    RunInBackground();
    Run();
  });
}

// Publishes the map as it was. Readers may know of revisions after the last that was stored: then
// it has a new number, and what comes after has newer ones still.
bool MappingPipeline::Restore(StoredCheckpoint checkpoint) {
  MapCheckpoint& map = checkpoint.map;
  const bool ended_in_order = checkpoint.reserved_through_revision == map.revision;
  if (!ended_in_order && !map.revisions.empty()) {
    RevisionRecord again = map.revisions.back();
    again.revision = map.revision = checkpoint.reserved_through_revision + 1;
    again.accepted.clear();
    again.dropped.clear();
    again.mean_move_m = again.largest_move_m = 0;
    map.revisions.push_back(again);
  }
  const auto snapshot = map_.Restore(map);
  if (!snapshot.ok()) {
    spdlog::warn("map {}: optimised anew: {}", sink_.map, snapshot.status().ToString());
    return false;
  }
  if (ended_in_order) {
    stored_revision_ = map.revision;
    stored_entries_ = entries_;
    absl::MutexLock lock(&mutex_);
    reserved_through_ = map.revision;
  } else {
    StoreCheckpointAndWait(map.revision + kReservedRevisions);
  }
  sink_.publish(*snapshot, map_.history());
  return true;
}

void MappingPipeline::Run() {
  LogFields fields;
  fields.map = sink_.map;
  const LogScope scope(&fields);
  while (!Stopping()) {
    // Neither memory running out nor a solver's exception may take the server along.
    try {
      const std::vector<Work> work = TakeWork();
      Iterate(work);
      StoreCheckpointWhenDue();
    } catch (const std::exception& error) {
      spdlog::error("map {}: mapping failed: {}", sink_.map, error.what());
    }
    absl::MutexLock lock(&mutex_);
    in_hand_ = 0;
  }
}

bool MappingPipeline::Stopping() const {
  absl::MutexLock lock(&mutex_);
  return stopping_;
}

std::vector<MappingPipeline::Work> MappingPipeline::TakeWork() {
  const bool all_stored = stored_revision_ == map_.revision();
  absl::MutexLock lock(&mutex_);
  const auto something_to_do = [this]() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    return stopping_ || !work_.empty();
  };
  const absl::Time deadline = map_.dirty() ? absl::InfinitePast()
                              : all_stored ? absl::InfiniteFuture()
                                           : checkpoint_due_;
  mutex_.AwaitWithDeadline(absl::Condition(&something_to_do), deadline);
  if (!work_.empty()) {
    mutex_.AwaitWithDeadline(absl::Condition(&stopping_), last_work_ + kMinInterval);
    last_work_ = absl::Now();
  }
  if (stopping_) return {};
  in_hand_ = static_cast<int64_t>(work_.size()) + (map_.dirty() ? 1 : 0);
  return std::exchange(work_, {});
}

void MappingPipeline::Apply(const Work& work) {
  const absl::Status status = work.apply(map_);
  if (work.done != nullptr) return work.done(status);
  ++entries_;
  // The store let it through, so a refusal here is a defect of ours: say so, and go on without it.
  if (!status.ok()) {
    LogPeer(spdlog::level::err, "refused by the map", "map {}: refused what was stored: {}",
            sink_.map, HeaderSafe(status.ToString()));
  }
}

void MappingPipeline::Iterate(const std::vector<Work>& work) {
  Stopwatch watch;
  CycleTimes times;
  for (const Work& item : work) Apply(item);
  if (!map_.dirty()) return;
  times.intake_s = watch.Lap();
  const std::shared_ptr<const MapSnapshot> snapshot = map_.Optimise(&give_up_);
  if (snapshot == nullptr) return;  // given up: the log has it all
  times.optimise_s = snapshot->optimisation_s;
  times.snapshot_s = std::max(0.0, watch.Lap() - snapshot->optimisation_s);
  spdlog::info("map {}: revision {}: {} missions, {} closures, cost {:.6g} -> {:.6g} in {:.3f} s",
               sink_.map, snapshot->revision, snapshot->missions.size(), snapshot->closures.size(),
               snapshot->initial_cost, snapshot->final_cost, snapshot->optimisation_s);
  uint64_t reserved = 0;
  {
    absl::MutexLock lock(&mutex_);
    reserved = reserved_through_;
  }
  // Nobody hears of a revision whose number could be given out again after a crash.
  if (snapshot->revision > reserved)
    StoreCheckpointAndWait(snapshot->revision + kReservedRevisions);
  times.store_s = watch.Lap();
  sink_.publish(snapshot, map_.history());
  times.publish_s = watch.Lap();
  if (sink_.timed != nullptr) sink_.timed(snapshot->revision, times);
}

void MappingPipeline::StoreCheckpoint(uint64_t reserved_through) {
  const absl::Time begin = absl::Now();
  stored_revision_ = map_.revision();
  stored_entries_ = entries_;
  std::string bytes = ToBytes({map_.Checkpoint(), entries_, reserved_through});
  {
    absl::MutexLock lock(&mutex_);
    ++checkpoints_under_way_;
  }
  sink_.store(std::move(bytes), [this, reserved_through](const absl::Status& status) {
    if (!status.ok()) {
      spdlog::warn("map {}: checkpoint not stored: {}", sink_.map, status.ToString());
    }
    absl::MutexLock lock(&mutex_);
    if (status.ok()) reserved_through_ = reserved_through;
    --checkpoints_under_way_;
  });
  const absl::Time end = absl::Now();
  checkpoint_due_ = end + std::max(kMinCheckpointInterval, (end - begin) * (1 / kCheckpointShare));
}

bool MappingPipeline::IsStored(uint64_t reserved_through) const {
  absl::MutexLock lock(&mutex_);
  return stored_revision_ == map_.revision() && stored_entries_ == entries_ &&
         reserved_through_ == reserved_through;
}

void MappingPipeline::StoreCheckpointAndWait(uint64_t reserved_through) {
  if (IsStored(reserved_through)) return;
  StoreCheckpoint(reserved_through);
  absl::MutexLock lock(&mutex_);
  const auto done = [this]() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    return checkpoints_under_way_ == 0;
  };
  mutex_.AwaitWithTimeout(absl::Condition(&done), kStoreTimeout);
}

void MappingPipeline::StoreCheckpointWhenDue() {
  // A checkpoint says that all its entries are in the revision: not so after a solve was given up.
  if (map_.dirty() || stored_revision_ == map_.revision() || absl::Now() < checkpoint_due_) return;
  {
    absl::MutexLock lock(&mutex_);
    if (checkpoints_under_way_ > 0) return;
  }
  StoreCheckpoint(map_.revision() + kReservedRevisions);
}

}  // namespace overtone
