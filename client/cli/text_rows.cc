// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/text_rows.h"

#include <fstream>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "overtone/core/common/line_reader.h"
#include "overtone/core/common/parse_number.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/geometry/parse_pose.h"

namespace overtone {

absl::Status ForEachRow(const std::string& path,
                        const std::function<absl::Status(Fields fields)>& row) {
  std::ifstream file(path);
  if (!file) return absl::NotFoundError(absl::StrCat(path, ": cannot be opened"));
  LineReader reader(file, path);
  absl::string_view line;
  while (reader.Next(&line)) {
    const std::vector<absl::string_view> fields =
        absl::StrSplit(line, absl::ByAnyChar(" \t"), absl::SkipEmpty());
    const absl::Status status = row(fields);
    if (!status.ok()) return reader.Error(status.message());
  }
  return reader.status();
}

absl::Status ExpectFields(Fields fields, size_t count) {
  if (fields.size() == count) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat(fields.size(), " fields where ", count, " are expected"));
}

absl::StatusOr<Rigid3d> ParsePlanarPose(Fields fields) {
  RETURN_IF_ERROR(ExpectFields(fields, 3));
  Eigen::Vector3d v;
  RETURN_IF_ERROR(ParseFiniteDoubles(fields, absl::MakeSpan(v.data(), 3)));
  return CheckedPose(Eigen::Vector3d(v.x(), v.y(), 0), ExpSO3({0, 0, v.z()}).coeffs());
}

}  // namespace overtone
