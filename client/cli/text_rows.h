// SPDX-License-Identifier: Apache-2.0
// Text files of one record a line, fields separated by blanks; blank lines and lines that begin
// with # are passed over.
#ifndef OVERTONE_CLIENT_CLI_TEXT_ROWS_H_
#define OVERTONE_CLIENT_CLI_TEXT_ROWS_H_

#include <functional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "absl/types/span.h"
#include "overtone/core/geometry/se3.h"

namespace overtone {

using Fields = absl::Span<const absl::string_view>;

// Calls `row` with the fields of each record, at least one. NotFound: cannot be opened. What `row`
// finds wrong becomes InvalidArgument "path:line: what".
absl::Status ForEachRow(const std::string& path,
                        const std::function<absl::Status(Fields fields)>& row);

// InvalidArgument unless there are `count` fields.
absl::Status ExpectFields(Fields fields, size_t count);

// Three fields x y heading [m, m, rad], in the plane z = 0, heading about z. InvalidArgument: not
// such numbers, or too far out (parse_pose.h).
absl::StatusOr<Rigid3d> ParsePlanarPose(Fields fields);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_TEXT_ROWS_H_
