// SPDX-License-Identifier: Apache-2.0
// The pages of a damaged SQLite file, read without SQLite: those of the file, and in their place
// those that the write-ahead log has committed. https://www.sqlite.org/fileformat2.html
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_RAW_PAGES_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_RAW_PAGES_H_

#include <cstdint>
#include <fstream>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "absl/strings/string_view.h"
#include "absl/types/optional.h"

namespace overtone {

class RawPages {
 public:
  // `path`: of the database; beside it `path`-wal. What cannot be read is not there.
  explicit RawPages(const std::string& path);

  // Pages count from 1.
  int64_t count() const { return count_; }
  // Of page_bytes, zeros where the file ends early. Empty: not there.
  std::string Page(int64_t number) const;

 private:
  void ReadLog();

  mutable std::ifstream file_;
  mutable std::ifstream log_;
  int64_t page_bytes_ = 4096;
  int64_t count_ = 0;
  std::map<int64_t, int64_t> in_log_;  // page: its offset in the log
};

// A cell of a table's leaf: what one row of a table looks like. Values as they were bound: numbers
// in `integer`, texts and blobs in `bytes`.
struct RawValue {
  enum class Type { kNull, kInteger, kText, kBlob };
  Type type = Type::kNull;
  int64_t integer = 0;
  std::string bytes;
};
struct RawRow {
  int64_t id = 0;
  std::vector<RawValue> values;
};

// Everything in the pages that looks like a row, whichever table it is of. Much of it may be wrong.
void ForEachRawRow(const RawPages& pages, const std::function<void(RawRow row)>& read);

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_RAW_PAGES_H_
