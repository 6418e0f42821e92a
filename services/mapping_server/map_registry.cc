// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/map_registry.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/ids.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/services/mapping_server/log_fields.h"
#include "spdlog/spdlog.h"

namespace overtone {

MapRegistry::MapRegistry(const ServerOptions& options)
    : options_(options), directory_(options.data_dir), closer_(1) {}

MapRegistry::~MapRegistry() {
  Stop();
  {
    absl::MutexLock lock(&mutex_);
    maps_.clear();
  }
  absl::MutexLock lock(&mutex_);
  mutex_.Await(absl::Condition(&open_, &std::multiset<std::string>::empty));
}

absl::Status MapRegistry::Open() {
  RETURN_IF_ERROR(directory_.Open());
  for (const std::string& id : directory_.Maps()) {
    auto map = OpenMap(id, HostedMap::Epoch::kKeep);
    const LogFields about = LogFieldsOf(id);
    const LogScope scope(&about);
    if (!map.ok()) {
      spdlog::error("map {} cannot be served: {}", id, map.status().ToString());
    } else if ((*map)->store().Missions().empty()) {
      continue;  // somebody once waited for it
    } else {
      Keep(*map);
    }
  }
  return absl::OkStatus();
}

std::shared_ptr<HostedMap> MapRegistry::Share(std::unique_ptr<HostedMap> map) {
  {
    absl::MutexLock lock(&mutex_);
    open_.insert(map->id());
  }
  return std::shared_ptr<HostedMap>(map.release(), [this](HostedMap* ended) {
    closer_.Post([this, ended] {
      const std::string id = ended->id();
      const bool empty = ended->store().Missions().empty();
      delete ended;
      if (empty) directory_.RemoveEmpty(id);
      absl::MutexLock lock(&mutex_);
      open_.erase(open_.find(id));
    });
  });
}

absl::StatusOr<std::shared_ptr<HostedMap>> MapRegistry::OpenMap(const std::string& id,
                                                                HostedMap::Epoch epoch) {
  ASSIGN_OR_RETURN(const std::string path, directory_.Prepare(id));
  ASSIGN_OR_RETURN(std::unique_ptr<HostedMap> map, HostedMap::Open(id, path, options_, epoch));
  return Share(std::move(map));
}

absl::Status MapRegistry::CheckAvailable(const std::string& id) const {
  if (stopping_) return absl::UnavailableError("the server is shutting down");
  if (rebuilding_.count(id) == 0) return absl::OkStatus();
  return absl::UnavailableError(absl::StrCat("map: '", id, "' is being changed; try again"));
}

absl::StatusOr<std::shared_ptr<HostedMap>> MapRegistry::Find(const std::string& id) const {
  RETURN_IF_ERROR(ValidateId(id, "map"));
  absl::MutexLock lock(&mutex_);
  const auto it = maps_.find(id);
  if (it != maps_.end()) return it->second;
  if (rebuilding_.count(id) > 0) RETURN_IF_ERROR(CheckAvailable(id));
  return absl::NotFoundError(absl::StrCat("map: there is no '", id, "'"));
}

absl::StatusOr<std::shared_ptr<HostedMap>> MapRegistry::Acquire(const std::string& id) {
  RETURN_IF_ERROR(ValidateId(id, "map"));
  {
    absl::MutexLock lock(&mutex_);
    // Who comes while it is opened, or closed by those who waited for it before, waits for that.
    const auto settled = [&]() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
      const auto waiting = waiting_.find(id);
      const bool held =
          maps_.count(id) > 0 || (waiting != waiting_.end() && !waiting->second.expired());
      return stopping_ || rebuilding_.count(id) > 0 || held ||
             (opening_.count(id) == 0 && open_.count(id) == 0);
    };
    mutex_.Await(absl::Condition(&settled));
    RETURN_IF_ERROR(CheckAvailable(id));
    const auto kept = maps_.find(id);
    if (kept != maps_.end()) return kept->second;
    for (auto it = waiting_.begin(); it != waiting_.end();) {
      it = it->second.expired() ? waiting_.erase(it) : std::next(it);
    }
    const auto waiting = waiting_.find(id);
    if (waiting != waiting_.end()) {
      if (std::shared_ptr<HostedMap> map = waiting->second.lock()) return map;
    }
    if (maps_.size() + waiting_.size() >= static_cast<size_t>(options_.limits.max_maps)) {
      return absl::ResourceExhaustedError(
          absl::StrCat("map: the server has ", options_.limits.max_maps, " already, its limit"));
    }
    opening_.insert(id);
  }
  absl::StatusOr<std::shared_ptr<HostedMap>> map = OpenMap(id, HostedMap::Epoch::kKeep);
  absl::MutexLock lock(&mutex_);
  opening_.erase(id);
  if (map.ok() && rebuilding_.count(id) > 0) return CheckAvailable(id);
  if (map.ok()) waiting_[id] = *map;
  return map;
}

void MapRegistry::Keep(const std::shared_ptr<HostedMap>& map) {
  absl::MutexLock lock(&mutex_);
  if (stopping_) return;  // stored while we end: kept, it would never be closed
  if (rebuilding_.count(map->id()) > 0) return;  // which opens it again
  maps_.emplace(map->id(), map);
  waiting_.erase(map->id());
}

std::vector<std::shared_ptr<HostedMap>> MapRegistry::List() const {
  absl::MutexLock lock(&mutex_);
  std::vector<std::shared_ptr<HostedMap>> maps;
  for (const auto& [id, map] : maps_) maps.push_back(map);
  return maps;
}

absl::StatusOr<std::shared_ptr<HostedMap>> MapRegistry::TakeAway(const std::string& id,
                                                                 Existing existing) {
  absl::MutexLock lock(&mutex_);
  RETURN_IF_ERROR(CheckAvailable(id));
  const auto found = maps_.find(id);
  const bool in_use = open_.count(id) > 0 || opening_.count(id) > 0;
  const bool is_there = found != maps_.end() || (!in_use && directory_.Has(id));
  if (!is_there && existing == Existing::kChange) {
    return absl::NotFoundError(absl::StrCat("map: there is no '", id, "'"));
  }
  if (is_there && existing == Existing::kCreate) {
    return absl::AlreadyExistsError(absl::StrCat("map: there is a '", id, "' already"));
  }
  if (!is_there && maps_.size() >= static_cast<size_t>(options_.limits.max_maps)) {
    return absl::ResourceExhaustedError(
        absl::StrCat("map: the server has ", options_.limits.max_maps, " already, its limit"));
  }
  rebuilding_.insert(id);
  if (found == maps_.end()) {
    const auto waiting = waiting_.find(id);
    return waiting == waiting_.end() ? nullptr : waiting->second.lock();
  }
  std::shared_ptr<HostedMap> map = std::move(found->second);
  maps_.erase(found);
  return map;
}

void MapRegistry::AwaitClosed(const std::string& id) {
  absl::MutexLock lock(&mutex_);
  const auto closed = [&]() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    return open_.count(id) == 0 && opening_.count(id) == 0;
  };
  mutex_.Await(absl::Condition(&closed));
}

absl::Status MapRegistry::Reopen(const std::string& id) {
  if (!directory_.Has(id)) return absl::OkStatus();
  ASSIGN_OR_RETURN(std::shared_ptr<HostedMap> map, OpenMap(id, HostedMap::Epoch::kNew));
  if (map->store().Missions().empty()) {
    map.reset();
    AwaitClosed(id);  // its files are gone then
    return absl::OkStatus();
  }
  absl::MutexLock lock(&mutex_);
  maps_.emplace(id, map);
  return absl::OkStatus();
}

absl::Status MapRegistry::Rebuild(
    const std::string& id, Existing existing, UploadSessions* sessions,
    const std::function<absl::Status(const std::string& path)>& change) {
  RETURN_IF_ERROR(ValidateId(id, "map"));
  ASSIGN_OR_RETURN(std::shared_ptr<HostedMap> map, TakeAway(id, existing));
  const std::string why = "the map is being changed; try again";
  sessions->End(id, absl::UnavailableError(why));
  if (map != nullptr) map->publisher().Stop(why);
  map.reset();
  AwaitClosed(id);
  absl::Status status;
  if (existing == Existing::kCreate && directory_.Has(id)) {
    status = absl::AlreadyExistsError(absl::StrCat("map: a robot has just begun '", id, "'"));
  } else {
    const absl::StatusOr<std::string> path = directory_.Prepare(id);
    status = path.ok() ? change(*path) : path.status();
  }
  status.Update(Reopen(id));
  absl::MutexLock lock(&mutex_);
  rebuilding_.erase(id);
  return status;
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
