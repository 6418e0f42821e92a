// SPDX-License-Identifier: Apache-2.0
// The only place where absl and gRPC codes meet; they are the same numbers.
#ifndef OVERTONE_PROTO_CONVERSION_STATUS_CONVERSION_H_
#define OVERTONE_PROTO_CONVERSION_STATUS_CONVERSION_H_

#include <string>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "absl/time/time.h"
#include "absl/types/optional.h"
#include "grpcpp/support/status.h"

namespace overtone {

// Besides code and message, the details carry a google.rpc.Status with
//   ErrorInfo     domain "overtone", reason: the code's name, e.g. "INVALID_ARGUMENT"
//   BadRequest    INVALID_ARGUMENT and OUT_OF_RANGE whose message begins with a field's path and a
//                 colon
//   QuotaFailure  RESOURCE_EXHAUSTED: the subject is the status' own (QuotaExceeded), or what comes
//                 before the message's colon
//   RetryInfo     UNAVAILABLE, RESOURCE_EXHAUSTED, ABORTED: the status' own delay
//                 (WithRetryDelay), or one second
grpc::Status ToGrpcStatus(const absl::Status& status);

// What a request id may look like: 1 to 64 of A-Z a-z 0-9 _ -.
bool IsRequestId(absl::string_view id);
// The error with a RequestInfo among its details. Ok stays as it is.
grpc::Status WithRequestId(const grpc::Status& status, absl::string_view id);

// A code that is none of the 17 becomes UNKNOWN. The status has its own delay if the details give
// one that is not the second said for want of knowledge.
// Its message ends with " (request ID)" if they name the request: the server's log has the same.
absl::Status FromGrpcStatus(const grpc::Status& status);

// RESOURCE_EXHAUSTED "subject: what", for details of their own. A subject, e.g. "robot/anna/calls",
// is whose quota and which.
absl::Status QuotaExceeded(absl::string_view subject, absl::string_view what);
absl::optional<std::string> QuotaSubjectOf(const absl::Status& status);

// When another try may succeed: not negative, at most a day, up to the next millisecond.
absl::Status WithRetryDelay(absl::Status status, absl::Duration delay);
absl::optional<absl::Duration> RetryDelayOf(const absl::Status& status);

// At most 1 kB of printable ASCII, fit for a header; other bytes are written \xNN.
std::string HeaderSafe(absl::string_view message);

}  // namespace overtone

#endif  // OVERTONE_PROTO_CONVERSION_STATUS_CONVERSION_H_
