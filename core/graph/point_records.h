// SPDX-License-Identifier: Apache-2.0
// What PCD and PLY have in common: a header names the fields of a record, then the records follow.
#ifndef OVERTONE_CORE_GRAPH_POINT_RECORDS_H_
#define OVERTONE_CORE_GRAPH_POINT_RECORDS_H_

#include <cstdint>
#include <istream>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "overtone/core/common/line_reader.h"
#include "overtone/core/graph/point_cloud.h"

namespace overtone {

struct PointField {
  enum class Kind { kSigned, kUnsigned, kFloat };

  std::string name;
  Kind kind = Kind::kFloat;
  int bytes = 4;      // of one element: 1, 2, 4 or 8; 4 or 8 of kFloat
  int64_t count = 1;  // elements, [1, 2^16]
};

struct PointRecordLayout {
  std::vector<PointField> fields;
  int64_t num_records = 0;
  bool ascii = false;  // else packed, little-endian
};

// The records from where `in` stands, `bytes_left` bytes before its end. `header` has read the
// lines before them and reads on when they are text; errors carry its name.
absl::StatusOr<PointCloud> ReadPointRecords(std::istream& in, LineReader& header,
                                            const PointRecordLayout& layout, int64_t bytes_left);

// The headers, up to and with the line that ends them; the first line has not been read. See
// point_cloud_io.h.
absl::StatusOr<PointRecordLayout> ReadPcdHeader(LineReader& lines);
absl::StatusOr<PointRecordLayout> ReadPlyHeader(LineReader& lines);

}  // namespace overtone

#endif  // OVERTONE_CORE_GRAPH_POINT_RECORDS_H_
