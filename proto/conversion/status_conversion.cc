// SPDX-License-Identifier: Apache-2.0
#include "overtone/proto/conversion/status_conversion.h"

#include <algorithm>

#include "absl/strings/ascii.h"
#include "absl/strings/str_format.h"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "overtone/proto/conversion/limits.h"

namespace overtone {
namespace {

constexpr char kDomain[] = "overtone";
constexpr int kRetryAfterS = 1;

bool IsPathCharacter(char c) {
  return absl::ascii_isalnum(c) || c == '_' || c == '.' || c == '[' || c == ']';
}

// "submap.keyframes[3].stamp_ns" of "submap.keyframes[3].stamp_ns: not after ..."; empty when there
// is no path.
absl::string_view FieldPath(absl::string_view message) {
  const absl::string_view path = message.substr(0, message.find(':'));
  const bool is_path =
      path.size() < message.size() && std::all_of(path.begin(), path.end(), IsPathCharacter);
  return is_path ? path : absl::string_view();
}

void AddErrorInfo(const absl::Status& status, google::rpc::Status& details) {
  google::rpc::ErrorInfo info;
  info.set_domain(kDomain);
  info.set_reason(absl::StatusCodeToString(status.code()));
  details.add_details()->PackFrom(info);
}

void AddBadRequest(absl::string_view message, google::rpc::Status& details) {
  const absl::string_view path = FieldPath(message);
  if (path.empty()) return;
  google::rpc::BadRequest bad_request;
  google::rpc::BadRequest::FieldViolation& violation = *bad_request.add_field_violations();
  violation.set_field(std::string(path));
  violation.set_description(
      std::string(absl::StripLeadingAsciiWhitespace(message.substr(path.size() + 1))));
  details.add_details()->PackFrom(bad_request);
}

void AddQuotaFailure(absl::string_view message, google::rpc::Status& details) {
  google::rpc::QuotaFailure failure;
  google::rpc::QuotaFailure::Violation& violation = *failure.add_violations();
  violation.set_subject(std::string(FieldPath(message)));
  violation.set_description(std::string(message));
  details.add_details()->PackFrom(failure);
}

void AddRetryInfo(google::rpc::Status& details) {
  google::rpc::RetryInfo retry;
  retry.mutable_retry_delay()->set_seconds(kRetryAfterS);
  details.add_details()->PackFrom(retry);
}

bool HelpsToRetry(absl::StatusCode code) {
  return code == absl::StatusCode::kUnavailable || code == absl::StatusCode::kAborted ||
         code == absl::StatusCode::kResourceExhausted;
}

}  // namespace

std::string HeaderSafe(absl::string_view message) {
  std::string safe;
  for (const char c : message) {
    if (absl::ascii_isprint(c)) {
      safe.push_back(c);
    } else {
      absl::StrAppendFormat(&safe, "\\x%02x", static_cast<unsigned char>(c));
    }
    if (safe.size() > limits::kMaxStatusMessageBytes) {
      safe.resize(limits::kMaxStatusMessageBytes - 3);
      safe += "...";
      break;
    }
  }
  return safe;
}

grpc::Status ToGrpcStatus(const absl::Status& status) {
  if (status.ok()) return grpc::Status::OK;
  const std::string message = HeaderSafe(status.message());
  google::rpc::Status details;
  details.set_code(static_cast<int>(status.code()));
  details.set_message(message);
  AddErrorInfo(status, details);
  if (absl::IsInvalidArgument(status) || absl::IsOutOfRange(status)) {
    AddBadRequest(message, details);
  }
  if (absl::IsResourceExhausted(status)) AddQuotaFailure(message, details);
  if (HelpsToRetry(status.code())) AddRetryInfo(details);
  return grpc::Status(static_cast<grpc::StatusCode>(status.code()), message,
                      details.SerializeAsString());
}

absl::Status FromGrpcStatus(const grpc::Status& status) {
  const int code = status.error_code();
  const bool known = code >= 0 && code <= static_cast<int>(absl::StatusCode::kUnauthenticated);
  return absl::Status(known ? static_cast<absl::StatusCode>(code) : absl::StatusCode::kUnknown,
                      status.error_message());
}

}  // namespace overtone
