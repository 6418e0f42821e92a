// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/submap_store/store_file.h"

#include <utility>

#include "overtone/core/common/status_macros.h"
#include "overtone/services/mapping_server/submap_store/store_format.h"
#include "overtone/services/mapping_server/submap_store/store_salvage.h"

namespace overtone {

StoreFile::StoreFile(std::string path, std::string vfs, LossList* losses)
    : path_(std::move(path)), vfs_(std::move(vfs)), losses_(losses) {
  if (!in_memory()) found_mark_ = StoreMark::Read(path_);
  mark_ = std::make_unique<StoreMark>(in_memory() ? "" : path_);
}

absl::StatusOr<std::unique_ptr<StoreFile>> StoreFile::Open(const std::string& path,
                                                           const std::string& vfs,
                                                           LossList* losses) {
  std::unique_ptr<StoreFile> file(new StoreFile(path, vfs, losses));
  absl::MutexLock write_lock(&file->write_mutex_);
  absl::MutexLock read_lock(&file->read_mutex_);
  absl::Status status = file->in_memory() ? absl::OkStatus() : CheckBeforeOpening(path);
  if (status.ok()) status = file->Connect();
  if (absl::IsDataLoss(status)) {
    losses->Add(std::string(status.message()));
    status = file->SalvageAndConnect();
  }
  RETURN_IF_ERROR(status);
  return file;
}

absl::Status StoreFile::Connect() {
  ASSIGN_OR_RETURN(writer_, StoreTables::Open(path_, SqliteDatabase::Mode::kCreate, vfs_));
  RETURN_IF_ERROR(ConfigureConnection(&writer_->database()));
  RETURN_IF_ERROR(PrepareStore(&writer_->database()));
  RETURN_IF_ERROR(CheckStructure(&writer_->database()));
  writer_->database().CountWalPages();
  if (in_memory()) return absl::OkStatus();
  ASSIGN_OR_RETURN(reader_, StoreTables::Open(path_, SqliteDatabase::Mode::kReadOnly, vfs_));
  return reader_->database().Execute("PRAGMA trusted_schema=OFF; PRAGMA cell_size_check=ON");
}

absl::Status StoreFile::Salvage() {
  absl::MutexLock write_lock(&write_mutex_);
  absl::MutexLock read_lock(&read_mutex_);
  return SalvageAndConnect();
}

absl::Status StoreFile::SalvageAndConnect() {
  if (in_memory()) return absl::DataLossError("the store in memory is damaged");
  writer_.reset();
  reader_.reset();
  RETURN_IF_ERROR(SalvageStore(path_, vfs_, losses_));
  return Connect();
}

}  // namespace overtone
