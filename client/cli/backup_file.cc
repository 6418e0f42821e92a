// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/backup_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "absl/memory/memory.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/sha256.h"

namespace overtone {
namespace {

constexpr size_t kChunkBytes = 256 << 10;

absl::Status CannotWrite(const std::string& path) {
  return absl::UnavailableError(absl::StrCat("cannot write ", path, ": ", std::strerror(errno)));
}

}  // namespace

absl::StatusOr<std::unique_ptr<BackupFileWriter>> BackupFileWriter::Create(
    const std::string& path) {
  const std::string part = path + ".part";
  // What robots saw: for its owner only.
  const int fd = open(part.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  if (fd < 0) return CannotWrite(part);
  return absl::WrapUnique(new BackupFileWriter(path, fd));
}

BackupFileWriter::~BackupFileWriter() {
  if (fd_ >= 0) close(fd_);
  if (!committed_) std::remove(PartPath().c_str());
}

absl::Status BackupFileWriter::Append(const std::string& bytes) {
  for (absl::string_view left = bytes; !left.empty();) {
    const ssize_t written = write(fd_, left.data(), left.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return CannotWrite(PartPath());
    left.remove_prefix(static_cast<size_t>(written));
  }
  return absl::OkStatus();
}

absl::Status BackupFileWriter::Commit() {
  if (fsync(fd_) != 0) return CannotWrite(PartPath());
  if (std::rename(PartPath().c_str(), path_.c_str()) != 0) return CannotWrite(path_);
  committed_ = true;
  const std::filesystem::path folder = std::filesystem::path(path_).parent_path();
  const int fd = open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  const bool synced = fd >= 0 && fsync(fd) == 0;
  if (fd >= 0) close(fd);
  return synced ? absl::OkStatus() : CannotWrite(path_);
}

absl::StatusOr<std::unique_ptr<BackupFileReader>> BackupFileReader::Open(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    return absl::NotFoundError(absl::StrCat(path, ": there is no such file"));
  }
  std::unique_ptr<BackupFileReader> reader(new BackupFileReader(path));
  if (!reader->in_) return absl::NotFoundError(absl::StrCat(path, ": cannot be read"));
  Sha256Sum sum;
  for (;;) {
    ASSIGN_OR_RETURN(const std::string chunk, reader->Next());
    if (chunk.empty()) break;
    reader->bytes_ += static_cast<int64_t>(chunk.size());
    sum.Add(chunk);
  }
  if (reader->bytes_ == 0) return absl::InvalidArgumentError(absl::StrCat(path, ": is empty"));
  reader->sha256_ = sum.Finish();
  reader->in_.clear();
  reader->in_.seekg(0);
  return reader;
}

absl::StatusOr<std::string> BackupFileReader::Next() {
  std::string chunk(kChunkBytes, '\0');
  in_.read(chunk.data(), static_cast<std::streamsize>(chunk.size()));
  if (in_.bad()) return absl::UnavailableError(absl::StrCat(path_, ": cannot be read"));
  chunk.resize(static_cast<size_t>(in_.gcount()));
  return chunk;
}

}  // namespace overtone
