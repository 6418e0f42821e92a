// SPDX-License-Identifier: Apache-2.0
// A copy of a map on its way in or out: one file in a folder of its own, gone with this object.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_MAP_TRANSFER_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_MAP_TRANSFER_H_

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace overtone {

// Bytes of a message's chunk, either way.
constexpr size_t kTransferChunkBytes = 256 << 10;

// Not thread-safe; may move from thread to thread.
class MapTransfer {
 public:
  // `folder`: where to make it (DataDirectory::Transfers). `slot` is held as long as this is.
  // ResourceExhausted: less than `bytes` of room, or the disk fails.
  static absl::StatusOr<std::unique_ptr<MapTransfer>> Begin(const std::string& folder,
                                                            int64_t bytes,
                                                            std::shared_ptr<void> slot);
  ~MapTransfer();
  MapTransfer(const MapTransfer&) = delete;
  MapTransfer& operator=(const MapTransfer&) = delete;

  // Of the file, which nobody has made yet.
  std::string path() const { return folder_ + "/map.db"; }

  // Makes the file with the first call. ResourceExhausted: the disk is full or fails.
  absl::Status Append(absl::string_view bytes);
  // What was appended is on disk, and the file closed: SQLite's locks on it, also under another
  // name, would end with our closing it later.
  absl::Status SyncAndClose();

  // At most kTransferChunkBytes; empty at the end. The first call opens the file.
  absl::StatusOr<std::string> ReadNext();
  // To the beginning.
  absl::Status Rewind();

 private:
  MapTransfer(std::string folder, std::shared_ptr<void> slot)
      : folder_(std::move(folder)), slot_(std::move(slot)) {}

  // Opens the file once.
  absl::Status Open(int flags);

  const std::string folder_;
  const std::shared_ptr<void> slot_;
  int fd_ = -1;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_MAP_TRANSFER_H_
