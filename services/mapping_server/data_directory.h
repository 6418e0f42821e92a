// SPDX-License-Identifier: Apache-2.0
// Where the server keeps its maps:
//   <path>/lock              held while a server runs on it
//   <path>/maps/<id>/map.db  one store for each map (submap_store.h)
//   <path>/transfers/        copies on their way in or out (map_transfer.h)
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_DATA_DIRECTORY_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_DATA_DIRECTORY_H_

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace overtone {

class DataDirectory {
 public:
  // Nothing is kept: as long as the process.
  static constexpr char kMemory[] = ":memory:";

  explicit DataDirectory(std::string path) : path_(std::move(path)) {}
  ~DataDirectory();

  DataDirectory(const DataDirectory&) = delete;
  DataDirectory& operator=(const DataDirectory&) = delete;

  // Makes what is missing, takes the lock and clears away what an earlier server left of transfers.
  // FailedPrecondition: another server holds it.
  // PermissionDenied, ResourceExhausted, ...: it cannot be written to. Each names the option.
  absl::Status Open();

  bool InMemory() const { return path_ == kMemory; }
  const std::string& path() const { return path_; }

  // Ids of the maps that have a folder, sorted.
  std::vector<std::string> Maps() const;
  // There is a store file of that map.
  bool Has(const std::string& map) const;
  // Of all that the map's folder holds; 0 in memory.
  int64_t BytesOf(const std::string& map) const;
  // A folder for transfers: the system's for temporary files in memory.
  std::string Transfers() const;
  // The map's store file, in a folder that is there.
  absl::StatusOr<std::string> Prepare(const std::string& map) const;
  // With all that its folder holds. Its files are closed. Nothing there: Ok.
  absl::Status Remove(const std::string& map) const;
  // The store and its folder, but nothing else that lies there (what was damaged, say).
  void RemoveEmpty(const std::string& map) const;

 private:
  std::string Folder(const std::string& map) const;

  const std::string path_;
  int lock_ = -1;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_DATA_DIRECTORY_H_
