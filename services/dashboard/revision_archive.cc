// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/dashboard/revision_archive.h"

#include <algorithm>
#include <utility>

#include "overtone/services/dashboard/track_frame.h"

namespace overtone {
namespace {

absl::Time PublishedTime(const v1::MapSummary& summary) {
  return absl::FromUnixSeconds(summary.published().seconds()) +
         absl::Nanoseconds(summary.published().nanos());
}

std::string ThinnedFrame(const MapView& view, int64_t max_nodes) {
  int64_t nodes = 0;
  for (const MissionView& mission : view.missions) nodes += mission.positions.track->size();
  const int stride = static_cast<int>((nodes + max_nodes - 1) / max_nodes);
  TrackFrame frame(view.summary.revision(), view.origin);
  for (const MissionView& mission : view.missions) {
    frame.Add(mission.number, Thinned(*mission.positions.track, std::max(1, stride)));
  }
  return frame.Release();
}

}  // namespace

void RevisionArchive::Add(const MapView& view) {
  const uint64_t epoch = view.summary.map_epoch();
  const uint64_t revision = view.summary.revision();
  if (revision == 0 || Frame(epoch, revision) != nullptr) return;
  auto frame = std::make_shared<const std::string>(ThinnedFrame(view, max_nodes_));
  absl::MutexLock lock(&mutex_);
  bytes_ += frame->size();
  seen_.push_back({epoch, revision, PublishedTime(view.summary), std::move(frame)});
  MakeRoom();
}

void RevisionArchive::MakeRoom() {
  while (bytes_ > max_bytes_ && seen_.size() > 1) {
    std::vector<SeenRevision> kept;
    const size_t older_half = (seen_.size() + 1) / 2;
    for (size_t i = 0; i < seen_.size(); ++i) {
      if (i < older_half && i % 2 == 1) {  // the first one stays
        bytes_ -= seen_[i].frame->size();
      } else {
        kept.push_back(std::move(seen_[i]));
      }
    }
    seen_ = std::move(kept);
  }
}

std::vector<SeenRevision> RevisionArchive::List() const {
  absl::MutexLock lock(&mutex_);
  return seen_;
}

std::shared_ptr<const std::string> RevisionArchive::Frame(uint64_t map_epoch,
                                                          uint64_t revision) const {
  absl::MutexLock lock(&mutex_);
  for (const SeenRevision& seen : seen_) {
    if (seen.map_epoch == map_epoch && seen.revision == revision) return seen.frame;
  }
  return nullptr;
}

}  // namespace overtone
