// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/store_replacement.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <system_error>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/services/mapping_server/submap_store/sqlite_submap_store.h"
#include "overtone/services/mapping_server/submap_store/store_mark.h"

namespace overtone {
namespace {

namespace fs = std::filesystem;

absl::Status DiskError(int error) {
  return absl::ResourceExhaustedError(absl::StrCat("the server's disk: ", std::strerror(error)));
}

absl::Status SyncFolder(const std::string& path) {
  const int fd = open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  const bool synced = fd >= 0 && fsync(fd) == 0;
  const int error = errno;
  if (fd >= 0) close(fd);
  return synced ? absl::OkStatus() : DiskError(error);
}

// The new store must not find the old one's log, which SQLite would take for its own.
absl::Status RemoveCompanions(const std::string& path) {
  for (const std::string& companion : {path + "-wal", path + "-shm", MarkPath(path)}) {
    std::error_code error;
    fs::remove(companion, error);
    if (error) return DiskError(error.value());
  }
  return absl::OkStatus();
}

SubmapStore::Sink Nobody() {
  SubmapStore::Sink sink;
  sink.on_submap = [](const MissionId&, const std::shared_ptr<const Submap>&) {};
  sink.on_loop_closure = [](const LoopClosure&) {};
  sink.on_finding = [](const std::string&) {};
  sink.on_cloud = [](const MissionId&, int64_t, const std::string&) {};
  sink.on_cloud_gone = [](const MissionId&, int64_t) {};
  return sink;
}

}  // namespace

absl::Status ReplaceStore(const std::string& from, const std::string& to) {
  const std::string folder = fs::path(to).parent_path().string();
  RETURN_IF_ERROR(RemoveCompanions(to));
  // On disk before the new file is: otherwise a power cut could bring them back beside it.
  RETURN_IF_ERROR(SyncFolder(folder));
  if (std::rename(from.c_str(), to.c_str()) != 0) return DiskError(errno);
  return SyncFolder(folder);
}

absl::Status DeleteFromStore(const std::string& path, const ServerLimits& limits,
                             const MissionId& mission) {
  ASSIGN_OR_RETURN(const auto store, SqliteSubmapStore::Open(path, limits, Nobody()));
  RETURN_IF_ERROR(store->Replay());
  return store->DeleteMission(mission);
}

std::string WithoutPath(absl::string_view message, absl::string_view path) {
  return absl::StrReplaceAll(message, {{absl::StrCat(path, ": "), ""}, {path, "the file"}});
}

}  // namespace overtone
