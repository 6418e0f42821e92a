// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/map_transfer.h"

#include <fcntl.h>
#include <stdlib.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {
namespace {

namespace fs = std::filesystem;

// Without the path: that is the server's own affair.
absl::Status DiskError(int error) {
  return absl::ResourceExhaustedError(absl::StrCat("the server's disk: ", std::strerror(error)));
}

}  // namespace

absl::StatusOr<std::unique_ptr<MapTransfer>> MapTransfer::Begin(const std::string& folder,
                                                                int64_t bytes,
                                                                std::shared_ptr<void> slot) {
  std::error_code error;
  const fs::space_info space = fs::space(folder, error);
  if (error) return DiskError(error.value());
  if (space.available < static_cast<uintmax_t>(bytes)) {
    return absl::ResourceExhaustedError(absl::StrCat("the server's disk has ", space.available,
                                                     " bytes left, and ", bytes, " are needed"));
  }
  std::string path = absl::StrCat(folder, "/overtone-XXXXXX");
  if (mkdtemp(path.data()) == nullptr) return DiskError(errno);  // for this user only
  return std::unique_ptr<MapTransfer>(new MapTransfer(std::move(path), std::move(slot)));
}

MapTransfer::~MapTransfer() {
  if (fd_ >= 0) close(fd_);
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

absl::Status MapTransfer::Open(int flags) {
  if (fd_ < 0) fd_ = open(path().c_str(), flags | O_CLOEXEC, 0600);
  return fd_ >= 0 ? absl::OkStatus() : DiskError(errno);
}

absl::Status MapTransfer::Append(absl::string_view bytes) {
  RETURN_IF_ERROR(Open(O_WRONLY | O_CREAT | O_EXCL));
  while (!bytes.empty()) {
    const ssize_t written = write(fd_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return DiskError(errno);
    bytes.remove_prefix(static_cast<size_t>(written));
  }
  return absl::OkStatus();
}

absl::Status MapTransfer::SyncAndClose() {
  const bool synced = fsync(fd_) == 0;
  const int error = errno;
  close(fd_);
  fd_ = -1;
  return synced ? absl::OkStatus() : DiskError(error);
}

absl::Status MapTransfer::Rewind() {
  return lseek(fd_, 0, SEEK_SET) == 0 ? absl::OkStatus() : DiskError(errno);
}

absl::StatusOr<std::string> MapTransfer::ReadNext() {
  RETURN_IF_ERROR(Open(O_RDONLY));
  std::string bytes(kTransferChunkBytes, '\0');
  size_t size = 0;
  while (size < bytes.size()) {
    const ssize_t got = read(fd_, bytes.data() + size, bytes.size() - size);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return DiskError(errno);
    if (got == 0) break;
    size += static_cast<size_t>(got);
  }
  bytes.resize(size);
  return bytes;
}

}  // namespace overtone
