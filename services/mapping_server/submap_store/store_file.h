// SPDX-License-Identifier: Apache-2.0
// The connections to a store's file: one that writes, one that reads and never waits for an fsync.
// A store in memory has one for both.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_STORE_FILE_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_STORE_FILE_H_

#include <memory>
#include <string>

#include "absl/base/thread_annotations.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "absl/types/optional.h"
#include "overtone/services/mapping_server/submap_store/loss_list.h"
#include "overtone/services/mapping_server/submap_store/store_mark.h"
#include "overtone/services/mapping_server/submap_store/store_tables.h"

namespace overtone {

// Thread-safe.
class StoreFile {
 public:
  // Makes the file, migrates it, salvages what there is in it when its structure is damaged.
  // FailedPrecondition: written by a newer version. ResourceExhausted, NotFound: the disk.
  static absl::StatusOr<std::unique_ptr<StoreFile>> Open(const std::string& path,
                                                         const std::string& vfs, LossList* losses);

  bool in_memory() const { return path_ == ":memory:"; }
  const std::string& path() const { return path_; }
  const std::string& vfs() const { return vfs_; }

  // `use(StoreTables&)` alone on the connection; gives the Status or StatusOr that it returns.
  // DataLoss also when an earlier Salvage failed.
  template <typename Use>
  auto Write(Use&& use) ABSL_LOCKS_EXCLUDED(write_mutex_) {
    absl::MutexLock lock(&write_mutex_);
    return With(writer_.get(), use);
  }
  template <typename Use>
  auto Read(Use&& use) const {
    absl::MutexLock lock(in_memory() ? &write_mutex_ : &read_mutex_);
    return With(in_memory() ? writer_.get() : reader_.get(), use);
  }

  // The structure is damaged: what can be read goes into a new file, the old one is kept under
  // another name and reported. All connections are new afterwards.
  absl::Status Salvage() ABSL_LOCKS_EXCLUDED(write_mutex_, read_mutex_);

  // How far it had come when it was last open, if anybody knows.
  const absl::optional<StateRow>& found_mark() const { return found_mark_; }
  // After each commit.
  void WriteMark(const StateRow& state) { mark_->Write(state); }

 private:
  template <typename Use>
  static auto With(StoreTables* tables, Use& use) -> decltype(use(*tables)) {
    if (tables == nullptr) return absl::DataLossError("the store could not be repaired yet");
    return use(*tables);
  }

  StoreFile(std::string path, std::string vfs, LossList* losses);

  absl::Status Connect() ABSL_EXCLUSIVE_LOCKS_REQUIRED(write_mutex_, read_mutex_);
  absl::Status SalvageAndConnect() ABSL_EXCLUSIVE_LOCKS_REQUIRED(write_mutex_, read_mutex_);

  const std::string path_;
  const std::string vfs_;
  LossList* const losses_;
  absl::optional<StateRow> found_mark_;
  std::unique_ptr<StoreMark> mark_;
  mutable absl::Mutex write_mutex_;
  mutable absl::Mutex read_mutex_ ABSL_ACQUIRED_AFTER(write_mutex_);
  std::unique_ptr<StoreTables> writer_ ABSL_GUARDED_BY(write_mutex_);
  std::unique_ptr<StoreTables> reader_ ABSL_GUARDED_BY(read_mutex_);
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_STORE_FILE_H_
