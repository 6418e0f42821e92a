// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/dashboard/cloud_cache.h"

#include <utility>

namespace overtone {
namespace {

constexpr size_t kHeaderBytes = 4096;
constexpr size_t kMaxBytesPerPoint = 64;

}  // namespace

std::shared_ptr<const std::string> CloudCache::Cached(const Key& key) {
  absl::MutexLock lock(&mutex_);
  const bool same =
      key.epoch == key_.epoch && key.revision == key_.revision && key.voxel_m == key_.voxel_m;
  return same ? file_ : nullptr;
}

absl::StatusOr<std::shared_ptr<const std::string>> CloudCache::Get(const MapView& view,
                                                                   double voxel_m) {
  const Key key = {view.summary.map_epoch(), view.summary.revision(), voxel_m};
  if (auto cached = Cached(key)) return cached;
  if (!export_mutex_.TryLock()) return absl::UnavailableError("a cloud is being made; ask again");
  absl::StatusOr<std::string> file =
      api_->Cloud(voxel_m, max_points_, kHeaderBytes + kMaxBytesPerPoint * max_points_);
  export_mutex_.Unlock();
  if (!file.ok()) return file.status();
  auto shared = std::make_shared<const std::string>(*std::move(file));
  absl::MutexLock lock(&mutex_);
  key_ = key;
  file_ = shared;
  return shared;
}

}  // namespace overtone
