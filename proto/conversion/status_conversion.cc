// SPDX-License-Identifier: Apache-2.0
#include "overtone/proto/conversion/status_conversion.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/cord.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "overtone/proto/conversion/limits.h"

namespace overtone {
namespace {

constexpr char kDomain[] = "overtone";
constexpr absl::Duration kUnknownRetryDelay = absl::Seconds(1);
constexpr absl::Duration kMaxRetryDelay = absl::Hours(24);
// Payloads are text, so that a logged status can be read.
constexpr char kRetryDelayUrl[] = "overtone/retry_delay";
constexpr char kQuotaSubjectUrl[] = "overtone/quota_subject";

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

void AddQuotaFailure(const absl::Status& status, absl::string_view message,
                     google::rpc::Status& details) {
  google::rpc::QuotaFailure failure;
  google::rpc::QuotaFailure::Violation& violation = *failure.add_violations();
  const absl::optional<std::string> subject = QuotaSubjectOf(status);
  violation.set_subject(subject.has_value() ? HeaderSafe(*subject)
                                            : std::string(FieldPath(message)));
  violation.set_description(std::string(message));
  details.add_details()->PackFrom(failure);
}

void AddRetryInfo(absl::Duration delay, google::rpc::Status& details) {
  google::rpc::RetryInfo retry;
  const int64_t seconds = absl::IDivDuration(delay, absl::Seconds(1), &delay);
  retry.mutable_retry_delay()->set_seconds(seconds);
  retry.mutable_retry_delay()->set_nanos(static_cast<int32_t>(absl::ToInt64Nanoseconds(delay)));
  details.add_details()->PackFrom(retry);
}

// The details that say something new, back into the status.
void TakeDetail(const google::protobuf::Any& detail, absl::Status& status) {
  google::rpc::RetryInfo retry;
  google::rpc::QuotaFailure quota;
  if (detail.Is<google::rpc::RetryInfo>() && detail.UnpackTo(&retry)) {
    const absl::Duration delay = absl::Seconds(retry.retry_delay().seconds()) +
                                 absl::Nanoseconds(retry.retry_delay().nanos());
    if (delay != kUnknownRetryDelay) status = WithRetryDelay(std::move(status), delay);
  } else if (detail.Is<google::rpc::QuotaFailure>() && detail.UnpackTo(&quota)) {
    if (quota.violations_size() == 0 || quota.violations(0).subject().empty()) return;
    if (quota.violations(0).subject() == FieldPath(status.message())) return;
    status.SetPayload(kQuotaSubjectUrl, absl::Cord(HeaderSafe(quota.violations(0).subject())));
  }
}

// As FromGrpcStatus appends it; empty: the details do not name the request.
std::string RequestSuffix(const google::rpc::Status& details) {
  google::rpc::RequestInfo info;
  for (const google::protobuf::Any& detail : details.details()) {
    if (!detail.Is<google::rpc::RequestInfo>() || !detail.UnpackTo(&info)) continue;
    if (IsRequestId(info.request_id())) return absl::StrCat(" (request ", info.request_id(), ")");
  }
  return "";
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
  if (absl::IsResourceExhausted(status)) AddQuotaFailure(status, message, details);
  if (HelpsToRetry(status.code())) {
    AddRetryInfo(RetryDelayOf(status).value_or(kUnknownRetryDelay), details);
  }
  return grpc::Status(static_cast<grpc::StatusCode>(status.code()), message,
                      details.SerializeAsString());
}

bool IsRequestId(absl::string_view id) {
  const auto fits = [](char c) { return absl::ascii_isalnum(c) || c == '_' || c == '-'; };
  return !id.empty() && id.size() <= 64 && std::all_of(id.begin(), id.end(), fits);
}

grpc::Status WithRequestId(const grpc::Status& status, absl::string_view id) {
  google::rpc::Status details;
  if (status.ok() || !IsRequestId(id)) return status;
  // Those of other services may have none, or none of this kind.
  if (!details.ParseFromString(status.error_details())) details.Clear();
  details.set_code(status.error_code());
  details.set_message(status.error_message());
  google::rpc::RequestInfo info;
  info.set_request_id(std::string(id));
  details.add_details()->PackFrom(info);
  return grpc::Status(status.error_code(), status.error_message(), details.SerializeAsString());
}

absl::Status FromGrpcStatus(const grpc::Status& status) {
  const int code = status.error_code();
  const bool known = code >= 0 && code <= static_cast<int>(absl::StatusCode::kUnauthenticated);
  google::rpc::Status details;
  const bool detailed = !status.ok() && details.ParseFromString(status.error_details());
  absl::Status result(known ? static_cast<absl::StatusCode>(code) : absl::StatusCode::kUnknown,
                      absl::StrCat(status.error_message(), RequestSuffix(details)));
  if (!detailed) return result;
  for (const google::protobuf::Any& detail : details.details()) TakeDetail(detail, result);
  return result;
}

absl::Status QuotaExceeded(absl::string_view subject, absl::string_view what) {
  absl::Status status = absl::ResourceExhaustedError(absl::StrCat(subject, ": ", what));
  status.SetPayload(kQuotaSubjectUrl, absl::Cord(subject));
  return status;
}

absl::optional<std::string> QuotaSubjectOf(const absl::Status& status) {
  const absl::optional<absl::Cord> payload = status.GetPayload(kQuotaSubjectUrl);
  if (!payload.has_value()) return absl::nullopt;
  return std::string(*payload);
}

absl::Status WithRetryDelay(absl::Status status, absl::Duration delay) {
  delay = std::min(std::max(delay, absl::ZeroDuration()), kMaxRetryDelay);
  const int64_t milliseconds = absl::ToInt64Milliseconds(absl::Ceil(delay, absl::Milliseconds(1)));
  status.SetPayload(kRetryDelayUrl, absl::Cord(absl::StrCat(milliseconds, "ms")));
  return status;
}

absl::optional<absl::Duration> RetryDelayOf(const absl::Status& status) {
  const absl::optional<absl::Cord> payload = status.GetPayload(kRetryDelayUrl);
  absl::Duration delay;
  if (!payload.has_value() || !absl::ParseDuration(std::string(*payload), &delay)) {
    return absl::nullopt;
  }
  return delay;
}

}  // namespace overtone
