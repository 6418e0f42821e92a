// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/mapping_pipeline.h"

#include <exception>
#include <utility>

#include "absl/time/clock.h"
#include "spdlog/spdlog.h"

namespace overtone {
namespace {

// A candidate after the other comes out of the front end: a revision for each would be mostly
// overhead, and nobody can use ten a second.
constexpr absl::Duration kMinInterval = absl::Milliseconds(100);

}  // namespace

MappingPipeline::MappingPipeline(const MultiRobotMapOptions& options, uint64_t map_epoch,
                                 Publish publish)
    : publish_(std::move(publish)), map_(options, map_epoch), thread_([this] { Run(); }) {}

MappingPipeline::~MappingPipeline() {
  {
    absl::MutexLock lock(&mutex_);
    stopping_ = true;
  }
  thread_.join();
  for (const Work& work : work_) {
    if (work.done != nullptr) work.done(absl::UnavailableError("the server is shutting down"));
  }
}

void MappingPipeline::AddSubmap(const MissionId& mission, std::shared_ptr<const Submap> submap) {
  Enqueue([mission, submap = std::move(submap)](MultiRobotMap& map) {
    return map.AddSubmap(mission, *submap);
  });
}

void MappingPipeline::AddLoopClosure(const LoopClosure& closure) {
  Enqueue([closure](MultiRobotMap& map) { return map.AddLoopClosure(closure); });
}

void MappingPipeline::AddCandidate(LoopCandidate candidate) {
  Enqueue([candidate = std::move(candidate)](MultiRobotMap& map) {
    return map.AddCandidate(candidate);
  });
}

void MappingPipeline::AddScoredCandidate(const ScoredCandidate& candidate) {
  Enqueue([candidate](MultiRobotMap& map) { return map.AddScoredCandidate(candidate); });
}

void MappingPipeline::AddMotion(const MotionMeasurement& motion) {
  Enqueue([motion](MultiRobotMap& map) { return map.AddMotion(motion); });
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

void MappingPipeline::Run() {
  for (std::vector<Work> work = TakeWork(); !work.empty(); work = TakeWork()) {
    // Neither memory running out nor a solver's exception may take the server along.
    try {
      Iterate(work);
    } catch (const std::exception& error) {
      spdlog::error("mapping failed: {}", error.what());
    }
    absl::MutexLock lock(&mutex_);
    in_hand_ = 0;
  }
}

std::vector<MappingPipeline::Work> MappingPipeline::TakeWork() {
  absl::MutexLock lock(&mutex_);
  const auto something_to_do = [this]() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    return stopping_ || !work_.empty();
  };
  mutex_.Await(absl::Condition(&something_to_do));
  mutex_.AwaitWithDeadline(absl::Condition(&stopping_), last_work_ + kMinInterval);
  last_work_ = absl::Now();
  if (stopping_) return {};
  in_hand_ = static_cast<int64_t>(work_.size());
  return std::exchange(work_, {});
}

void MappingPipeline::Iterate(const std::vector<Work>& work) {
  for (const Work& item : work) {
    const absl::Status status = item.apply(map_);
    if (item.done != nullptr) {
      item.done(status);
    } else if (!status.ok()) {
      // The store let it through, so a refusal here is a defect of ours: say so, and go on without
      // it.
      spdlog::error("the map refused what was stored: {}", status.ToString());
    }
  }
  if (!map_.dirty()) return;
  const std::shared_ptr<const MapSnapshot> snapshot = map_.Optimise();
  spdlog::info("revision {}: {} missions, {} closures, cost {:.6g} -> {:.6g} in {:.3f} s",
               snapshot->revision, snapshot->missions.size(), snapshot->closures.size(),
               snapshot->initial_cost, snapshot->final_cost, snapshot->optimisation_s);
  publish_(snapshot, map_.history().records().back());
}

}  // namespace overtone
