// SPDX-License-Identifier: Apache-2.0
#include "overtone/proto/conversion/status_conversion.h"

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
