// SPDX-License-Identifier: Apache-2.0
// A file system for SQLite that fails on command: the system's own, in between which power cuts and
// errors are played. Syncs do not reach the disk, which makes it fast: what counts as synced is
// kept here.
#ifndef OVERTONE_TESTS_SUPPORT_FAULT_VFS_H_
#define OVERTONE_TESTS_SUPPORT_FAULT_VFS_H_

#include <cstdint>
#include <map>
#include <mutex>
#include <random>
#include <string>
#include <vector>

namespace overtone {

// One for the process; thread-safe. An operation is a write, a truncation or a sync of any file.
class FaultVfs {
 public:
  // Registered with SQLite under name() at the first call.
  static FaultVfs& Instance();
  static const char* name() { return "overtone_fault"; }

  // Nothing fails, no operation was counted, no file is known.
  void Reset();
  int64_t operations() const;

  // After that many more operations every further one fails, and has no effect.
  void CutPowerAfter(int64_t operations);
  bool power_is_off() const;
  // What is on the disk after the cut: of each file what was synced, and of the writes after that
  // any that the disk fancied, whole or up to some sector. Files that were opened under
  // `from` + suffix are written to `to` + suffix.
  void WriteSurvivors(const std::string& from, const std::string& to, std::mt19937& random);

  // `times` operations fail with this extended error code of SQLite, after that many more. A sync
  // that fails makes nothing durable.
  void FailAfter(int64_t operations, int code, int64_t times);
  // One bit of what is read, after that many more reads.
  void FlipBitAfterReads(int64_t reads, std::mt19937 random);

  // For the file methods.
  int OnWrite(const std::string& path, int64_t offset, const std::string& bytes);
  int OnTruncate(const std::string& path, int64_t size);
  int OnSync(const std::string& path);
  void OnDelete(const std::string& path);
  void OnRead(char* bytes, int64_t size);

 private:
  struct Change {
    int64_t offset = 0;  // -1: truncated to `size`
    int64_t size = 0;
    std::string bytes;
  };
  struct File {
    std::string durable;
    bool ever_synced = false;
    std::vector<Change> pending;
  };

  FaultVfs();
  // Counts; the error that the operation has to end with, or 0.
  int Pass();
  static void Apply(const Change& change, std::string& content);

  mutable std::mutex mutex_;
  std::map<std::string, File> files_;
  int64_t operations_ = 0;
  int64_t power_until_ = -1;  // -1: for ever
  int64_t fail_from_ = -1;
  int64_t fail_until_ = -1;
  int fail_code_ = 0;
  int64_t reads_until_flip_ = -1;
  std::mt19937 flip_random_;
};

}  // namespace overtone

#endif  // OVERTONE_TESTS_SUPPORT_FAULT_VFS_H_
