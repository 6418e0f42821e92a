// SPDX-License-Identifier: Apache-2.0
// How far a store had come when it last acknowledged something, in a small file beside it. Damage
// to the write-ahead log makes SQLite forget the last commits without a word; this remembers that
// they were there. Written after each commit and not synced: after a power cut it may be behind,
// which hides nothing that it would otherwise show, and never says too much.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_STORE_MARK_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_STORE_MARK_H_

#include <string>

#include "absl/types/optional.h"
#include "overtone/services/mapping_server/submap_store/store_rows.h"

namespace overtone {

class StoreMark {
 public:
  // `path`: of the store. Empty: none is kept.
  explicit StoreMark(const std::string& path);
  ~StoreMark();
  StoreMark(const StoreMark&) = delete;
  StoreMark& operator=(const StoreMark&) = delete;

  // nullopt: not there or damaged.
  static absl::optional<StateRow> Read(const std::string& path);
  // What fails is left out: the mark only guards against further damage.
  void Write(const StateRow& state);

 private:
  int fd_ = -1;
};

// The file beside the store.
std::string MarkPath(const std::string& path);

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_STORE_MARK_H_
