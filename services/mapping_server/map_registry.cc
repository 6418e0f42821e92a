// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/map_registry.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/ids.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {

MapRegistry::MapRegistry(const ServerOptions& options)
    : options_(options), disposal_(std::make_unique<DisposalThread>()) {}

absl::StatusOr<std::shared_ptr<HostedMap>> MapRegistry::Find(const std::string& id) const {
  RETURN_IF_ERROR(ValidateId(id, "map"));
  absl::MutexLock lock(&mutex_);
  const auto it = maps_.find(id);
  if (it != maps_.end()) return it->second;
  return absl::NotFoundError(absl::StrCat("map: there is no '", id, "'"));
}

absl::StatusOr<std::shared_ptr<HostedMap>> MapRegistry::Acquire(const std::string& id) {
  RETURN_IF_ERROR(ValidateId(id, "map"));
  absl::MutexLock lock(&mutex_);
  if (stopping_) return absl::UnavailableError("the server is shutting down");
  const auto kept = maps_.find(id);
  if (kept != maps_.end()) return kept->second;
  for (auto it = waiting_.begin(); it != waiting_.end();) {
    it = it->second.expired() ? waiting_.erase(it) : std::next(it);
  }
  std::weak_ptr<HostedMap>& waiting = waiting_[id];
  if (std::shared_ptr<HostedMap> map = waiting.lock()) return map;
  if (maps_.size() + waiting_.size() > static_cast<size_t>(options_.limits.max_maps)) {
    waiting_.erase(id);
    return absl::ResourceExhaustedError(
        absl::StrCat("map: the server has ", options_.limits.max_maps, " already, its limit"));
  }
  // The last to let go of a map that never was kept may be its store's own thread.
  std::shared_ptr<HostedMap> map(new HostedMap(id, options_),
                                 [dispose = disposal_->disposer()](HostedMap* gone) {
                                   dispose([gone] { delete gone; });
                                 });
  waiting = map;
  return map;
}

void MapRegistry::Keep(const std::shared_ptr<HostedMap>& map) {
  absl::MutexLock lock(&mutex_);
  maps_.emplace(map->id(), map);
  waiting_.erase(map->id());
}

std::vector<std::shared_ptr<HostedMap>> MapRegistry::List() const {
  absl::MutexLock lock(&mutex_);
  std::vector<std::shared_ptr<HostedMap>> maps;
  for (const auto& [id, map] : maps_) maps.push_back(map);
  return maps;
}

void MapRegistry::Stop() {
  std::vector<std::shared_ptr<HostedMap>> maps;
  {
    absl::MutexLock lock(&mutex_);
    stopping_ = true;
    for (const auto& [id, map] : maps_) maps.push_back(map);
    for (const auto& [id, waiting] : waiting_) {
      if (std::shared_ptr<HostedMap> map = waiting.lock()) maps.push_back(std::move(map));
    }
  }
  for (const std::shared_ptr<HostedMap>& map : maps) map->publisher().Stop();
}

}  // namespace overtone
