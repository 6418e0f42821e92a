// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/map_maintenance.h"

#include <filesystem>
#include <system_error>
#include <utility>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/field_path.h"
#include "overtone/proto/conversion/sha256.h"
#include "overtone/services/mapping_server/store_replacement.h"
#include "overtone/services/mapping_server/submap_store/store_verify.h"
#include "spdlog/spdlog.h"

namespace overtone {
namespace {

// Each takes as much disk as its map, as long as its peer takes its time.
constexpr int kMaxTransfers = 4;

absl::Status InMemory(const char* what) {
  return absl::FailedPreconditionError(
      absl::StrCat("data_dir: this server keeps its maps in memory, where ", what));
}

}  // namespace

MapMaintenance::MapMaintenance(const ServerLimits& limits, MapRegistry* registry,
                               UploadSessions* sessions)
    : limits_(limits), registry_(registry), sessions_(sessions), housekeeper_(1) {}

absl::Status MapMaintenance::CheckRunning() const {
  if (!stopping_) return absl::OkStatus();
  return absl::UnavailableError("the server is shutting down");
}

absl::StatusOr<std::unique_ptr<MapTransfer>> MapMaintenance::BeginTransfer(int64_t bytes) {
  const std::shared_ptr<void> slot(nullptr, [transfers = transfers_](void*) { --*transfers; });
  if (++*transfers_ > kMaxTransfers) {
    return absl::ResourceExhaustedError(absl::StrCat(
        "map: ", kMaxTransfers, " backups and restores are under way already, the limit"));
  }
  return MapTransfer::Begin(registry_->directory().Transfers(), bytes, slot);
}

absl::StatusOr<MapMaintenance::Backup> MapMaintenance::BackUp(const std::string& map) {
  RETURN_IF_ERROR(CheckRunning());
  Backup backup;
  {
    ASSIGN_OR_RETURN(const std::shared_ptr<HostedMap> hosted, registry_->Find(map));
    ASSIGN_OR_RETURN(backup.file, BeginTransfer(registry_->directory().BytesOf(map)));
    RETURN_IF_ERROR(hosted->store().Backup(backup.file->path()));
  }
  Sha256Sum sum;
  for (;;) {
    ASSIGN_OR_RETURN(const std::string bytes, backup.file->ReadNext());
    if (bytes.empty()) break;
    backup.bytes += static_cast<int64_t>(bytes.size());
    sum.Add(bytes);
  }
  backup.sha256 = sum.Finish();
  RETURN_IF_ERROR(backup.file->Rewind());
  spdlog::info("map {}: an operator takes a backup of {} bytes", map, backup.bytes);
  return backup;
}

absl::StatusOr<std::unique_ptr<MapTransfer>> MapMaintenance::BeginRestore(const std::string& map,
                                                                          int64_t bytes,
                                                                          bool replace) {
  RETURN_IF_ERROR(CheckRunning());
  RETURN_IF_ERROR(ValidateId(map, "header.map"));
  if (registry_->directory().InMemory()) return InMemory("a backup cannot be restored");
  if (bytes < 1) return InvalidField("header.total_bytes", absl::StrCat(bytes, " is below 1"));
  if (bytes > limits_.max_restore_bytes) {
    return absl::ResourceExhaustedError(
        absl::StrCat("header.total_bytes: ", bytes, " are more than the ",
                     limits_.max_restore_bytes, " of limits.max_restore_bytes"));
  }
  if (!replace && registry_->Find(map).ok()) {
    return absl::AlreadyExistsError(absl::StrCat("map: there is a '", map, "' already"));
  }
  return BeginTransfer(bytes);
}

absl::StatusOr<MapMaintenance::Restored> MapMaintenance::Restore(const std::string& map,
                                                                 bool replace, MapTransfer& file) {
  RETURN_IF_ERROR(CheckRunning());
  RETURN_IF_ERROR(file.SyncAndClose());
  Restored restored;
  absl::StatusOr<StoreReport> report = VerifyStoreFile(file.path());
  if (!report.ok()) {
    // Its path is the server's own affair.
    return absl::Status(report.status().code(),
                        absl::StrCat("the file is no backup that can be restored: ",
                                     WithoutPath(report.status().message(), file.path())));
  }
  restored.report = *std::move(report);
  const auto existing = replace ? MapRegistry::Existing::kEither : MapRegistry::Existing::kCreate;
  RETURN_IF_ERROR(registry_->Rebuild(map, existing, sessions_, [&](const std::string& path) {
    return ReplaceStore(file.path(), path);
  }));
  restored.map_epoch = EpochOf(map);
  spdlog::warn("map {}: an operator restored a backup with {} missions and {} submaps", map,
               restored.report.missions, restored.report.submaps);
  return restored;
}

absl::StatusOr<StoreReport> MapMaintenance::Verify(const std::string& map) {
  RETURN_IF_ERROR(CheckRunning());
  ASSIGN_OR_RETURN(const std::shared_ptr<HostedMap> hosted, registry_->Find(map));
  return hosted->store().Verify();
}

absl::StatusOr<MapMaintenance::Deleted> MapMaintenance::DeleteMission(const std::string& map,
                                                                      const MissionId& mission) {
  RETURN_IF_ERROR(CheckRunning());
  {
    // A slip of the pen must not end everybody's streams.
    ASSIGN_OR_RETURN(const std::shared_ptr<HostedMap> hosted, registry_->Find(map));
    if (hosted->store().Missions().count(mission) == 0) {
      return absl::NotFoundError(
          absl::StrCat("mission: there is no ", ToString(mission), " in map '", map, "'"));
    }
  }
  if (registry_->directory().InMemory()) return InMemory("only the map as a whole can be deleted");
  ASSIGN_OR_RETURN(const Deleted deleted, Delete(map, [&](const std::string& path) {
                     return DeleteFromStore(path, limits_, mission);
                   }));
  spdlog::warn("map {}: an operator deleted mission {}", map, ToString(mission));
  return deleted;
}

absl::StatusOr<MapMaintenance::Deleted> MapMaintenance::DeleteMap(const std::string& map) {
  RETURN_IF_ERROR(CheckRunning());
  ASSIGN_OR_RETURN(const Deleted deleted, Delete(map, [&](const std::string&) {
                     return registry_->directory().Remove(map);
                   }));
  spdlog::warn("map {}: an operator deleted it", map);
  return deleted;
}

absl::StatusOr<MapMaintenance::Deleted> MapMaintenance::Delete(
    const std::string& map, const std::function<absl::Status(const std::string& path)>& what) {
  int64_t before = 0;
  RETURN_IF_ERROR(registry_->Rebuild(map, MapRegistry::Existing::kChange, sessions_,
                                     [&](const std::string& path) {
                                       before = registry_->directory().BytesOf(map);  // closed
                                       return what(path);
                                     }));
  return Deleted{EpochOf(map), before - registry_->directory().BytesOf(map)};
}

uint64_t MapMaintenance::EpochOf(const std::string& map) const {
  const absl::StatusOr<std::shared_ptr<HostedMap>> hosted = registry_->Find(map);
  return hosted.ok() ? (*hosted)->epoch() : 0;
}

}  // namespace overtone
