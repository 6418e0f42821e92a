// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/data_directory.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/ids.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {
namespace {

namespace fs = std::filesystem;

absl::Status Error(const std::string& path, const std::error_code& error) {
  return absl::ErrnoToStatus(error.value(), absl::StrCat("data_dir: ", path));
}

// Maps hold what robots saw: for the server's user only.
absl::Status MakePrivateFolder(const std::string& path) {
  std::error_code error;
  const bool made = fs::create_directories(path, error);
  if (!error && made) fs::permissions(path, fs::perms::owner_all, error);
  return error ? Error(path, error) : absl::OkStatus();
}

}  // namespace

DataDirectory::~DataDirectory() {
  if (lock_ >= 0) close(lock_);
}

absl::Status DataDirectory::Open() {
  if (InMemory()) return absl::OkStatus();
  RETURN_IF_ERROR(MakePrivateFolder(path_));
  RETURN_IF_ERROR(MakePrivateFolder(absl::StrCat(path_, "/maps")));
  const std::string lock = absl::StrCat(path_, "/lock");
  lock_ = open(lock.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (lock_ < 0) return absl::ErrnoToStatus(errno, absl::StrCat("data_dir: ", lock));
  if (flock(lock_, LOCK_EX | LOCK_NB) != 0) {
    return absl::FailedPreconditionError(absl::StrCat("data_dir: another server runs on ", path_,
                                                      "; stop it or use another folder"));
  }
  std::error_code error;
  fs::remove_all(Transfers(), error);
  return error ? Error(Transfers(), error) : MakePrivateFolder(Transfers());
}

std::string DataDirectory::Transfers() const {
  std::error_code ignored;
  return InMemory() ? fs::temp_directory_path(ignored).string() : path_ + "/transfers";
}

std::string DataDirectory::Folder(const std::string& map) const {
  return absl::StrCat(path_, "/maps/", map);
}

std::vector<std::string> DataDirectory::Maps() const {
  std::vector<std::string> maps;
  if (InMemory()) return maps;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(path_ + "/maps", error)) {
    const std::string name = entry.path().filename();
    if (entry.is_directory(error) && ValidateId(name, "map").ok()) maps.push_back(name);
  }
  std::sort(maps.begin(), maps.end());
  return maps;
}

bool DataDirectory::Has(const std::string& map) const {
  std::error_code ignored;
  return !InMemory() && fs::exists(absl::StrCat(Folder(map), "/map.db"), ignored);
}

int64_t DataDirectory::BytesOf(const std::string& map) const {
  int64_t bytes = 0;
  std::error_code error;
  if (InMemory()) return bytes;
  for (const fs::directory_entry& entry : fs::directory_iterator(Folder(map), error)) {
    const uintmax_t size = entry.file_size(error);
    if (!error) bytes += static_cast<int64_t>(size);
  }
  return bytes;
}

absl::StatusOr<std::string> DataDirectory::Prepare(const std::string& map) const {
  if (InMemory()) return std::string(kMemory);
  RETURN_IF_ERROR(MakePrivateFolder(Folder(map)));
  return absl::StrCat(Folder(map), "/map.db");
}

absl::Status DataDirectory::Remove(const std::string& map) const {
  if (InMemory()) return absl::OkStatus();
  std::error_code error;
  fs::remove_all(Folder(map), error);
  return error ? Error(Folder(map), error) : absl::OkStatus();
}

void DataDirectory::RemoveEmpty(const std::string& map) const {
  if (InMemory()) return;
  std::error_code ignored;
  for (const char* file : {"/map.db", "/map.db-wal", "/map.db-shm", "/map.db-mark"}) {
    fs::remove(Folder(map) + file, ignored);
  }
  fs::remove(Folder(map), ignored);  // fails while something else lies there
}

}  // namespace overtone
