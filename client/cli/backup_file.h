// SPDX-License-Identifier: Apache-2.0
// A map's backup on this computer's disk.
#ifndef OVERTONE_CLIENT_CLI_BACKUP_FILE_H_
#define OVERTONE_CLIENT_CLI_BACKUP_FILE_H_

#include <cstdint>
#include <fstream>
#include <memory>
#include <string>
#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace overtone {

// Not thread-safe. Until Commit it is called FILE.part, and goes when it is never committed: under
// its own name there is a whole backup or none.
class BackupFileWriter {
 public:
  // Unavailable: the file cannot be made.
  static absl::StatusOr<std::unique_ptr<BackupFileWriter>> Create(const std::string& path);
  ~BackupFileWriter();
  BackupFileWriter(const BackupFileWriter&) = delete;
  BackupFileWriter& operator=(const BackupFileWriter&) = delete;

  absl::Status Append(const std::string& bytes);
  // Down to the disk, and then in the place of what may be there.
  absl::Status Commit();

 private:
  BackupFileWriter(std::string path, int fd) : path_(std::move(path)), fd_(fd) {}
  std::string PartPath() const { return path_ + ".part"; }

  const std::string path_;
  int fd_;
  bool committed_ = false;
};

// Not thread-safe.
class BackupFileReader {
 public:
  // Reads it once for its size and digest. NotFound; InvalidArgument: it is empty.
  static absl::StatusOr<std::unique_ptr<BackupFileReader>> Open(const std::string& path);

  int64_t bytes() const { return bytes_; }
  const std::string& sha256() const { return sha256_; }

  // At most 256 KiB; empty at the end.
  absl::StatusOr<std::string> Next();

 private:
  explicit BackupFileReader(const std::string& path) : path_(path), in_(path, std::ios::binary) {}

  const std::string path_;
  std::ifstream in_;
  int64_t bytes_ = 0;
  std::string sha256_;
};

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_BACKUP_FILE_H_
