// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/dashboard/map_mirror.h"

#include <algorithm>
#include <utility>

#include "absl/time/clock.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {
namespace {

constexpr absl::Duration kRateWindow = absl::Seconds(5);

// Nothing of a map that is not there, or no longer.
void Forget(MapView& view) {
  MapView empty;
  view.summary = empty.summary;
  view.missions.clear();
  view.robots.clear();
  view.closures = empty.closures;
  view.revisions = empty.revisions;
  view.closures_version = view.revisions_version = view.version;
}

}  // namespace

MapMirror::MapMirror(MapApi* api, RevisionArchive* history, const MirrorOptions& options)
    : api_(api),
      history_(history),
      options_(options),
      tracker_(api, options.max_nodes),
      rates_(kRateWindow),
      thread_([this] { Run(); }) {}

MapMirror::~MapMirror() { Stop(); }

std::shared_ptr<const MapView> MapMirror::view() const {
  absl::MutexLock lock(&mutex_);
  return view_;
}

std::shared_ptr<const MapView> MapMirror::WaitForNewer(uint64_t version,
                                                       absl::Duration timeout) const {
  absl::MutexLock lock(&mutex_);
  const auto is_newer = [this, version]() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    return stopping_ || view_->version > version;
  };
  mutex_.AwaitWithTimeout(absl::Condition(&is_newer), timeout);
  return view_;
}

void MapMirror::AskNow() {
  absl::MutexLock lock(&mutex_);
  asked_now_ = true;
}

void MapMirror::Stop() {
  {
    absl::MutexLock lock(&mutex_);
    stopping_ = true;
  }
  if (thread_.joinable()) thread_.join();
}

bool MapMirror::stopped() const {
  absl::MutexLock lock(&mutex_);
  return stopping_;
}

void MapMirror::Run() {
  const auto is_due = [this]()
                          ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) { return asked_now_ || stopping_; };
  absl::MutexLock lock(&mutex_);
  while (!stopping_) {
    asked_now_ = false;
    MapView next = *view_;
    ++next.version;
    mutex_.Unlock();
    const absl::Time start = absl::Now();
    next.link = Round(next);
    if (next.link.ok()) next.refreshed = absl::Now();
    Publish(std::move(next));
    const absl::Duration pause = std::max(options_.interval, 2 * (absl::Now() - start));
    mutex_.Lock();
    mutex_.AwaitWithTimeout(absl::Condition(&is_due), pause);
  }
}

absl::Status MapMirror::Round(MapView& view) {
  ASSIGN_OR_RETURN(const std::vector<v1::MapSummary> maps, api_->Maps());
  if (!view.link.ok()) {  // perhaps another server now
    ASSIGN_OR_RETURN(const v1::GetServerInfoResponse info, api_->ServerInfo());
    view.server_version = info.version();
    tracker_.Reconnected();
  }
  view.maps.clear();
  for (const v1::MapSummary& map : maps) view.maps.push_back(map.map());
  const auto found = std::find_if(maps.begin(), maps.end(), [this](const v1::MapSummary& map) {
    return map.map() == api_->map();
  });
  view.map_exists = found != maps.end();
  if (!view.map_exists) {
    loaded_epoch_ = 0;
    Forget(view);
    return absl::OkStatus();
  }
  view.summary = *found;
  RETURN_IF_ERROR(LoadRevision(view));
  ASSIGN_OR_RETURN(std::vector<v1::Robot> robots, api_->Robots());
  RETURN_IF_ERROR(tracker_.LoadReports(robots, view.version));
  LoadRobots(std::move(robots), view);
  view.missions = tracker_.missions();
  history_->Add(view);
  return absl::OkStatus();
}

absl::Status MapMirror::LoadRevision(MapView& view) {
  const v1::MapSummary& summary = view.summary;
  if (summary.map_epoch() == loaded_epoch_ && summary.revision() == loaded_revision_ &&
      summary.loop_closures() == loaded_closures_) {
    return absl::OkStatus();
  }
  RETURN_IF_ERROR(tracker_.LoadRevision(view.version));
  view.origin = tracker_.origin();
  ASSIGN_OR_RETURN(auto closures, api_->LoopClosures(options_.max_closures));
  ASSIGN_OR_RETURN(auto revisions, api_->Revisions(options_.max_revisions));
  view.closures = std::make_shared<const decltype(closures)>(std::move(closures));
  view.revisions = std::make_shared<const decltype(revisions)>(std::move(revisions));
  view.closures_version = view.revisions_version = view.version;
  loaded_epoch_ = summary.map_epoch();
  loaded_revision_ = summary.revision();
  loaded_closures_ = summary.loop_closures();
  return absl::OkStatus();
}

void MapMirror::LoadRobots(std::vector<v1::Robot> robots, MapView& view) {
  const absl::Time now = absl::Now();
  view.robots.clear();
  for (v1::Robot& robot : robots) {
    RobotView row;
    row.received_bytes_per_s = rates_.Add(robot.robot() + " up", now, robot.bytes_received());
    row.sent_bytes_per_s = rates_.Add(robot.robot() + " down", now, robot.bytes_sent());
    row.robot = std::move(robot);
    view.robots.push_back(std::move(row));
  }
}

void MapMirror::Publish(MapView view) {
  auto published = std::make_shared<const MapView>(std::move(view));
  absl::MutexLock lock(&mutex_);
  view_ = std::move(published);
}

}  // namespace overtone
