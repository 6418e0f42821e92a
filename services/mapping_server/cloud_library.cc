// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/cloud_library.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/graph/point_cloud_codec.h"
#include "overtone/core/place_recognition/cloud_gathering.h"
#include "overtone/core/place_recognition/field_of_view.h"

namespace overtone {

void CloudLibrary::AddSubmap(const MissionId& mission, const Submap& submap) {
  absl::MutexLock lock(&mutex_);
  std::vector<KeyframeEntry>& entries = missions_[mission];
  for (const Keyframe& keyframe : submap.keyframes) {
    KeyframeEntry entry;
    entry.mission_from_body = keyframe.mission_from_body;
    if (!entries.empty()) {
      entry.previous_from_this =
          entries.back().mission_from_body.Inverse() * keyframe.mission_from_body;
      entry.travelled_m = entries.back().travelled_m + entry.previous_from_this.translation.norm();
    }
    entries.push_back(std::move(entry));
  }
  for (const KeyframeCloud& cloud : submap.clouds) entries[cloud.index].expects_cloud = true;
}

void CloudLibrary::AddCloud(const NodeId& node, const std::string& sha256) {
  absl::MutexLock lock(&mutex_);
  KeyframeEntry* entry = Find(node);
  if (entry == nullptr) return;
  entry->expects_cloud = true;
  entry->sha256 = sha256;
}

void CloudLibrary::CloudGone(const NodeId& node) {
  absl::MutexLock lock(&mutex_);
  KeyframeEntry* entry = Find(node);
  if (entry != nullptr) entry->expects_cloud = false;
}

CloudLibrary::KeyframeEntry* CloudLibrary::Find(const NodeId& node) {
  return const_cast<KeyframeEntry*>(std::as_const(*this).Find(node));
}

const CloudLibrary::KeyframeEntry* CloudLibrary::Find(const NodeId& node) const {
  const auto entries = missions_.find(node.mission);
  if (entries == missions_.end() || node.index < 0 ||
      node.index >= static_cast<int64_t>(entries->second.size())) {
    return nullptr;
  }
  return &entries->second[node.index];
}

bool CloudLibrary::HasCloud(const NodeId& node) const {
  absl::MutexLock lock(&mutex_);
  const KeyframeEntry* entry = Find(node);
  return entry != nullptr && !entry->sha256.empty();
}

bool CloudLibrary::ExpectsCloud(const NodeId& node) const {
  absl::MutexLock lock(&mutex_);
  const KeyframeEntry* entry = Find(node);
  return entry != nullptr && entry->expects_cloud;
}

Rigid3d CloudLibrary::MotionInto(const NodeId& node) const {
  absl::MutexLock lock(&mutex_);
  const KeyframeEntry* entry = Find(node);
  return entry == nullptr ? Rigid3d() : entry->previous_from_this;
}

void CloudLibrary::SetMotionInto(const NodeId& node, const Rigid3d& previous_from_this) {
  absl::MutexLock lock(&mutex_);
  KeyframeEntry* entry = Find(node);
  if (entry != nullptr) entry->previous_from_this = previous_from_this;
}

absl::StatusOr<std::vector<CloudLibrary::Part>> CloudLibrary::PartsOf(const NodeId& node,
                                                                      PlaceView* view) const {
  absl::MutexLock lock(&mutex_);
  const KeyframeEntry* own = Find(node);
  if (own == nullptr || own->sha256.empty()) {
    return absl::NotFoundError(absl::StrCat(ToString(node), " has no cloud"));
  }
  view->node = node;
  view->travelled_m = own->travelled_m;
  view->mission_from_body = own->mission_from_body.rotation;
  const std::vector<KeyframeEntry>& entries = missions_.at(node.mission);
  std::vector<Part> parts;
  Rigid3d newest_from_this;
  for (int64_t i = node.index; i >= 0; --i) {
    if (own->travelled_m - entries[i].travelled_m > gather_length_m_) break;
    if (!entries[i].sha256.empty()) parts.push_back({newest_from_this, entries[i].sha256});
    newest_from_this = newest_from_this * entries[i].previous_from_this.Inverse();
  }
  return parts;
}

absl::StatusOr<PlaceView> CloudLibrary::Scan(const NodeId& node) const {
  PlaceView view;
  ASSIGN_OR_RETURN(const std::vector<Part> parts, PartsOf(node, &view));
  ASSIGN_OR_RETURN(PointCloud cloud, Load(parts.front()));
  view.cloud = std::make_shared<const PointCloud>(std::move(cloud));
  view.single_scan = true;
  return view;
}

absl::StatusOr<PointCloud> CloudLibrary::Load(const Part& part) const {
  ASSIGN_OR_RETURN(const std::shared_ptr<const std::string> blob, source_(part.sha256));
  return DecodePointCloud(*blob);
}

// In the body frame of the first part, the newest keyframe.
PointCloud CloudLibrary::Gather(const std::vector<Part>& parts) const {
  std::vector<CloudAtPose> keyframes;  // oldest first
  for (auto part = parts.rbegin(); part != parts.rend(); ++part) {
    absl::StatusOr<PointCloud> cloud = Load(*part);
    if (!cloud.ok()) continue;
    keyframes.push_back(
        {part->newest_from_this, std::make_shared<const PointCloud>(*std::move(cloud))});
  }
  return GatherClouds(keyframes, gather_length_m_);
}

absl::StatusOr<std::shared_ptr<const PlaceView>> CloudLibrary::View(const NodeId& node) {
  {
    absl::MutexLock lock(&mutex_);
    std::shared_ptr<const PlaceView> known = views_.Find(node);
    if (known != nullptr) return known;
  }
  PlaceView view;
  ASSIGN_OR_RETURN(const std::vector<Part> parts, PartsOf(node, &view));
  ASSIGN_OR_RETURN(PointCloud cloud, Load(parts.front()));
  if (parts.size() > 1 && !SeesAllAround(cloud)) cloud = Gather(parts);
  view.cloud = std::make_shared<const PointCloud>(std::move(cloud));
  auto shared = std::make_shared<const PlaceView>(std::move(view));
  absl::MutexLock lock(&mutex_);
  views_.Insert(node, shared);
  return shared;
}

}  // namespace overtone
