// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/internal/leftover_missions.h"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include "overtone/client/internal/exception_guard.h"
#include "overtone/client/internal/loop_closure_uploader.h"
#include "overtone/client/internal/submap_uploader.h"

namespace overtone {
namespace {

std::vector<MissionOutbox> FindLeftovers(const MappingClientOptions& options) {
  if (options.outbox_dir.empty()) return {};
  std::vector<MissionOutbox> found = FindOutboxes(options.outbox_dir, options.mission.robot);
  const auto is_current = [&](const MissionOutbox& outbox) {
    return outbox.map == options.map && outbox.mission == options.mission;
  };
  found.erase(std::remove_if(found.begin(), found.end(), is_current), found.end());
  return found;
}

}  // namespace

LeftoverMissions::LeftoverMissions(v1::MappingService::Stub* stub,
                                   const MappingClientOptions& options, TrafficCounters* counters,
                                   TokenBucket* bucket, Logger logger)
    : stub_(stub),
      options_(options),
      counters_(counters),
      bucket_(bucket),
      logger_(std::move(logger)),
      missions_(FindLeftovers(options)),
      waiting_(static_cast<int64_t>(missions_.size())) {
  if (!missions_.empty()) thread_ = std::thread([this] { Run(); });
}

LeftoverMissions::~LeftoverMissions() {
  {
    absl::MutexLock lock(&mutex_);
    stopping_ = true;
    if (outbox_ != nullptr) outbox_->Close();
  }
  if (thread_.joinable()) thread_.join();
}

void LeftoverMissions::Run() {
  for (const MissionOutbox& mission : missions_) {
    const absl::Status status =
        GuardExceptions("leftovers", [&] { return Handle(mission), absl::OkStatus(); });
    if (!status.ok()) logger_.Error(status.ToString());
    absl::MutexLock lock(&mutex_);
    if (stopping_) return;
  }
}

void LeftoverMissions::Handle(const MissionOutbox& mission) {
  auto outbox = SubmapOutbox::Open(options_.outbox_capacity_bytes, mission.path, logger_);
  if (!outbox.ok()) {
    logger_.Warning(mission.path, " cannot be sent: ", outbox.status().ToString());
    return;
  }
  if (!Hold(outbox->get())) return;
  const End end = Send(mission, **outbox);
  Hold(nullptr);
  if (end == End::kAllSent) {
    logger_.Info("all of mission ", mission.mission.mission, " is at the server");
    (*outbox)->RemoveFile();
    --waiting_;
    return;
  }
  (*outbox)->Flush().IgnoreError();  // if not, the server says again what it has
  if (end != End::kRefused) return;
  outbox->reset();  // all in one file
  std::error_code error;
  std::filesystem::rename(mission.path, mission.path + ".refused", error);
  --waiting_;
}

// False: we are to stop.
bool LeftoverMissions::Hold(SubmapOutbox* outbox) {
  absl::MutexLock lock(&mutex_);
  outbox_ = outbox;
  return !stopping_;
}

LeftoverMissions::End LeftoverMissions::Send(const MissionOutbox& mission, SubmapOutbox& outbox) {
  std::atomic<End> end{End::kAllSent};
  const auto stop_because = [&](End reason, const absl::Status& status) {
    logger_.Error("mission ", mission.mission.mission, " of map ", mission.map,
                  " is not sent to its end: ", status.ToString());
    end = reason;
    outbox.Close();
  };
  const auto new_backoff = [&] { return Backoff(options_.initial_backoff, options_.max_backoff); };
  SubmapUploader::Settings settings{mission.map, mission.mission, new_backoff()};
  settings.bucket = bucket_;
  SubmapUploader::Listener listener;
  listener.on_refusal = [&](int64_t /*sequence*/, const absl::Status& reason) {
    // The server holds another of that sequence, and goes on behind it.
    if (!absl::IsAlreadyExists(reason)) stop_because(End::kRefused, reason);
  };
  listener.on_drop = [] {};
  listener.on_gap = [&](int64_t /*first_waiting*/, const absl::Status& reason) {
    stop_because(End::kGap, reason);
  };
  SubmapUploader submaps(stub_, std::move(settings), &outbox, counters_, logger_, listener);
  LoopClosureUploader closures(
      stub_, new_backoff(), &outbox, counters_, logger_,
      [&](const absl::Status& reason) {
        logger_.Error("loop closures refused for good: ", reason.ToString());
      },
      bucket_);
  submaps.Notify();
  while (!outbox.AwaitEmpty(options_.outbox_sync_interval)) {
    if (outbox.Closed()) return end == End::kAllSent ? End::kStopped : end.load();
    outbox.Flush().IgnoreError();
  }
  return End::kAllSent;
}

}  // namespace overtone
