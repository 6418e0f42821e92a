// SPDX-License-Identifier: Apache-2.0
#include "overtone/proto/conversion/status_conversion.h"

#include <cstdint>
#include <limits>
#include <string>

#include "gmock/gmock.h"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "gtest/gtest.h"

namespace overtone {
namespace {

google::rpc::Status Details(const grpc::Status& status) {
  google::rpc::Status details;
  EXPECT_TRUE(details.ParseFromString(status.error_details()));
  return details;
}

// The detail of that type; a default one when there is none.
template <typename Detail>
Detail Find(const google::rpc::Status& details) {
  Detail detail;
  for (const google::protobuf::Any& any : details.details()) {
    if (any.UnpackTo(&detail)) return detail;
  }
  return Detail();
}

TEST(StatusConversion, EveryCodeSurvivesTheRoundTrip) {
  for (int code = 0; code <= 16; ++code) {
    const absl::Status status(static_cast<absl::StatusCode>(code), code == 0 ? "" : "field: why");
    const grpc::Status sent = ToGrpcStatus(status);
    EXPECT_EQ(static_cast<int>(sent.error_code()), code);
    EXPECT_EQ(FromGrpcStatus(sent), status);
  }
}

TEST(StatusConversion, TheRequestIsInTheDetailsAndAtTheEndOfTheSentence) {
  const grpc::Status plain = ToGrpcStatus(absl::UnavailableError("field: why"));
  const grpc::Status named = WithRequestId(plain, "7f3a-B_9");
  EXPECT_EQ(named.error_code(), plain.error_code());
  EXPECT_EQ(named.error_message(), plain.error_message());
  EXPECT_EQ(Find<google::rpc::RequestInfo>(Details(named)).request_id(), "7f3a-B_9");
  EXPECT_EQ(Find<google::rpc::ErrorInfo>(Details(named)).reason(), "UNAVAILABLE");  // as before
  EXPECT_EQ(FromGrpcStatus(named), absl::UnavailableError("field: why (request 7f3a-B_9)"));
  // One that has no details, or not ours.
  for (const char* details : {"", "\xff\xff"}) {
    const grpc::Status other(grpc::StatusCode::UNIMPLEMENTED, "no such call", details);
    EXPECT_EQ(FromGrpcStatus(WithRequestId(other, "1")),
              absl::UnimplementedError("no such call (request 1)"));
  }
  EXPECT_TRUE(WithRequestId(grpc::Status::OK, "1").error_details().empty());
}

TEST(StatusConversion, WhatIsNoRequestIdIsNotTakenForOne) {
  const grpc::Status plain = ToGrpcStatus(absl::UnavailableError("why"));
  for (const std::string& bad : {std::string(), std::string(65, 'a'), std::string("a b"),
                                 std::string("a\n"), std::string("\xff")}) {
    EXPECT_FALSE(IsRequestId(bad));
    EXPECT_EQ(WithRequestId(plain, bad).error_details(), plain.error_details());
    google::rpc::Status details = Details(plain);
    google::rpc::RequestInfo info;
    if (bad != "\xff") info.set_request_id(bad);
    details.add_details()->PackFrom(info);
    EXPECT_EQ(FromGrpcStatus(grpc::Status(plain.error_code(), "why", details.SerializeAsString())),
              absl::UnavailableError("why"));
  }
  EXPECT_TRUE(IsRequestId(std::string(64, 'Z')));
}

TEST(StatusConversion, AnUnknownCodeBecomesUnknown) {
  for (const int code : {-1, 17, 31}) {  // beyond 31, gRPC's enum cannot hold it
    const grpc::Status status(static_cast<grpc::StatusCode>(code), "what");
    EXPECT_EQ(FromGrpcStatus(status).code(), absl::StatusCode::kUnknown);
  }
}

TEST(StatusConversion, InvalidArgumentNamesTheField) {
  const auto details = Details(
      ToGrpcStatus(absl::InvalidArgumentError("submap.keyframes[3].stamp_ns: 5 is not after: 7")));
  const auto bad_request = Find<google::rpc::BadRequest>(details);
  ASSERT_EQ(bad_request.field_violations_size(), 1);
  EXPECT_EQ(bad_request.field_violations(0).field(), "submap.keyframes[3].stamp_ns");
  EXPECT_EQ(bad_request.field_violations(0).description(), "5 is not after: 7");
  const auto info = Find<google::rpc::ErrorInfo>(details);
  EXPECT_EQ(info.domain(), "overtone");
  EXPECT_EQ(info.reason(), "INVALID_ARGUMENT");
}

TEST(StatusConversion, AMessageWithoutAFieldHasNoViolations) {
  const auto details = Details(ToGrpcStatus(absl::InvalidArgumentError("no such thing: really")));
  EXPECT_EQ(Find<google::rpc::BadRequest>(details).field_violations_size(), 0);
}

TEST(StatusConversion, WhatHelpsToRetrySaysWhen) {
  for (int code = 1; code <= 16; ++code) {
    const auto status_code = static_cast<absl::StatusCode>(code);
    const auto details = Details(ToGrpcStatus(absl::Status(status_code, "map: full")));
    const bool retry = status_code == absl::StatusCode::kUnavailable ||
                       status_code == absl::StatusCode::kAborted ||
                       status_code == absl::StatusCode::kResourceExhausted;
    EXPECT_EQ(Find<google::rpc::RetryInfo>(details).retry_delay().seconds(), retry ? 1 : 0) << code;
    const bool quota = status_code == absl::StatusCode::kResourceExhausted;
    EXPECT_EQ(Find<google::rpc::QuotaFailure>(details).violations_size(), quota ? 1 : 0) << code;
  }
}

TEST(StatusConversion, AStatusCarriesItsOwnDelayAndSubjectThereAndBack) {
  for (const absl::Duration delay :
       {absl::ZeroDuration(), absl::Milliseconds(1), absl::Milliseconds(2750), absl::Hours(3)}) {
    const absl::Status status =
        WithRetryDelay(QuotaExceeded("robot/anna/calls", "at most 5 per second"), delay);
    const grpc::Status sent = ToGrpcStatus(status);
    const auto violation = Find<google::rpc::QuotaFailure>(Details(sent)).violations(0);
    EXPECT_EQ(violation.subject(), "robot/anna/calls");
    EXPECT_EQ(violation.description(), "robot/anna/calls: at most 5 per second");
    const auto retry = Find<google::rpc::RetryInfo>(Details(sent)).retry_delay();
    EXPECT_EQ(retry.seconds() * 1'000'000'000 + retry.nanos(), absl::ToInt64Nanoseconds(delay));
    const absl::Status received = FromGrpcStatus(sent);
    EXPECT_EQ(RetryDelayOf(received), delay);
    EXPECT_EQ(QuotaSubjectOf(received), "robot/anna/calls");
    EXPECT_EQ(received, status);
  }
}

TEST(StatusConversion, DelaysAreRoundedUpAndKeptWithinADay) {
  const auto kept = [](absl::Duration delay) {
    return *RetryDelayOf(WithRetryDelay(absl::UnavailableError("later"), delay));
  };
  EXPECT_EQ(kept(absl::Nanoseconds(1)), absl::Milliseconds(1));
  EXPECT_EQ(kept(absl::Seconds(-5)), absl::ZeroDuration());
  EXPECT_EQ(kept(absl::InfiniteDuration()), absl::Hours(24));
}

// Whatever a server puts there.
TEST(StatusConversion, HostileDetailsDoNoHarm) {
  google::rpc::RetryInfo retry;
  retry.mutable_retry_delay()->set_seconds(std::numeric_limits<int64_t>::max());
  retry.mutable_retry_delay()->set_nanos(-2'000'000'000);
  google::rpc::QuotaFailure quota;
  quota.add_violations()->set_subject("a\nb");
  google::rpc::Status details;
  details.add_details()->PackFrom(retry);
  details.add_details()->PackFrom(quota);
  const absl::Status received =
      FromGrpcStatus(grpc::Status(grpc::StatusCode::UNAVAILABLE, "x", details.SerializeAsString()));
  EXPECT_EQ(RetryDelayOf(received), absl::Hours(24));
  EXPECT_EQ(QuotaSubjectOf(received), "a\\x0ab");
  const absl::Status garbage =
      FromGrpcStatus(grpc::Status(grpc::StatusCode::UNAVAILABLE, "x", "\x01\xff garbage"));
  EXPECT_EQ(garbage, absl::UnavailableError("x"));
}

TEST(StatusConversion, MessagesAreCappedAndPrintable) {
  const grpc::Status status =
      ToGrpcStatus(absl::InternalError(std::string(1 << 20, '\xff') + "\r\n"));
  EXPECT_EQ(status.error_message().size(), 1024u);
  EXPECT_THAT(status.error_message(), ::testing::StartsWith("\\xff\\xff"));
  EXPECT_THAT(status.error_message(), ::testing::EndsWith("..."));
  EXPECT_EQ(HeaderSafe("a\nb\xc3\xa9"), "a\\x0ab\\xc3\\xa9");
  EXPECT_EQ(HeaderSafe(std::string(1024, 'a')).size(), 1024u);
  EXPECT_THAT(HeaderSafe(std::string(1024, 'a')), ::testing::Not(::testing::EndsWith("...")));
}

}  // namespace
}  // namespace overtone
