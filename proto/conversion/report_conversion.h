// SPDX-License-Identifier: Apache-2.0
// What a robot tells about itself, checked before anybody keeps or shows it.
#ifndef OVERTONE_PROTO_CONVERSION_REPORT_CONVERSION_H_
#define OVERTONE_PROTO_CONVERSION_REPORT_CONVERSION_H_

#include "absl/status/status.h"
#include "overtone/v1/report.pb.h"

namespace overtone {

// As the comments in report.proto state them; both ends keep to these.
namespace report_limits {
constexpr int kMaxNodes = 500;
constexpr int kMaxConstraintEnds = 200;
constexpr int kMaxConstraintCounts = 16;  // kinds; a newer client may know more than we do
constexpr int kMaxVersionBytes = 64;
constexpr int kMaxHeldBackBytes = 1024;
}  // namespace report_limits

// InvalidArgument naming the field: a number is negative or not finite where it must not be, a
// column has another length than `index`, a list or text is too long, or a text has control
// characters. Absent fields are fine.
absl::Status Validate(const v1::LinkReport& link);
absl::Status Validate(const v1::ComparisonReport& comparison);

}  // namespace overtone

#endif  // OVERTONE_PROTO_CONVERSION_REPORT_CONVERSION_H_
