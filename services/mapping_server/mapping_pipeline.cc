// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/mapping_pipeline.h"

#include <exception>
#include <utility>

#include "spdlog/spdlog.h"

namespace overtone {

MappingPipeline::MappingPipeline(const MultiRobotMapOptions& options, uint64_t map_epoch,
                                 Publish publish)
    : publish_(std::move(publish)), map_(options, map_epoch), thread_([this] { Run(); }) {}

MappingPipeline::~MappingPipeline() {
  {
    absl::MutexLock lock(&mutex_);
    stopping_ = true;
  }
  thread_.join();
}

void MappingPipeline::AddSubmap(const MissionId& mission, std::shared_ptr<const Submap> submap) {
  Enqueue([mission, submap = std::move(submap)](MultiRobotMap& map) {
    return map.AddSubmap(mission, *submap);
  });
}

void MappingPipeline::AddLoopClosure(const LoopClosure& closure) {
  Enqueue([closure](MultiRobotMap& map) { return map.AddLoopClosure(closure); });
}

void MappingPipeline::Enqueue(Work work) {
  absl::MutexLock lock(&mutex_);
  work_.push_back(std::move(work));
}

void MappingPipeline::Run() {
  for (std::vector<Work> work = TakeWork(); !work.empty(); work = TakeWork()) {
    // Neither memory running out nor a solver's exception may take the server along.
    try {
      Iterate(work);
    } catch (const std::exception& error) {
      spdlog::error("mapping failed: {}", error.what());
    }
  }
}

std::vector<MappingPipeline::Work> MappingPipeline::TakeWork() {
  absl::MutexLock lock(&mutex_);
  const auto something_to_do = [this]() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    return stopping_ || !work_.empty();
  };
  mutex_.Await(absl::Condition(&something_to_do));
  if (stopping_) return {};
  return std::exchange(work_, {});
}

void MappingPipeline::Iterate(const std::vector<Work>& work) {
  for (const Work& item : work) {
    // The store let it through, so a refusal here is a defect of ours: say so, and go on without
    // it.
    const absl::Status status = item(map_);
    if (!status.ok()) spdlog::error("the map refused what was stored: {}", status.ToString());
  }
  if (!map_.dirty()) return;
  const std::shared_ptr<const MapSnapshot> snapshot = map_.Optimise();
  spdlog::info("revision {}: {} missions, {} closures, cost {:.6g} -> {:.6g} in {:.3f} s",
               snapshot->revision, snapshot->missions.size(), snapshot->closures.size(),
               snapshot->initial_cost, snapshot->final_cost, snapshot->optimisation_s);
  publish_(snapshot);
}

}  // namespace overtone
