// SPDX-License-Identifier: Apache-2.0
// The quotas as peers meet them.
#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "gtest/gtest.h"
#include "overtone/proto/conversion/status_conversion.h"
#include "overtone/tests/services/mapping_server/cloud_fixture.h"
#include "overtone/tests/services/mapping_server/server_fixture.h"

namespace overtone {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using testing::MakeSubmap;
using testing::ServerTest;
using testing::TestOptions;
using testing::Uploader;

const MissionId kAnna = {"anna", "run1"};

class QuotaRefusalsTest : public ServerTest {
 protected:
  void SetUp() override {}

  absl::Status AskUploadState(const std::string& robot) {
    v1::GetUploadStateRequest request;
    request.set_map("mine");
    *request.mutable_mission() = ToProto(MissionId{robot, "run1"});
    v1::GetUploadStateResponse response;
    grpc::ClientContext context;
    context.set_deadline(testing::Deadline());
    return FromGrpcStatus(mapping_->GetUploadState(&context, request, &response));
  }
};

TEST_F(QuotaRefusalsTest, CallsBeyondTheRateAreToldWhenAndOtherRobotsCallOn) {
  ServerOptions options = TestOptions();
  options.quotas.max_calls_per_s = 0.01;
  options.quotas.calls_burst = 3;
  StartServer(options);
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(AskUploadState("anna").ok());
  const absl::Status refused = AskUploadState("anna");
  EXPECT_EQ(refused.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(QuotaSubjectOf(refused), "robot/anna/calls");
  ASSERT_TRUE(RetryDelayOf(refused).has_value());
  EXPECT_GT(*RetryDelayOf(refused), absl::Seconds(60));
  EXPECT_LE(*RetryDelayOf(refused), absl::Seconds(100));
  EXPECT_TRUE(AskUploadState("bert").ok());
}

TEST_F(QuotaRefusalsTest, AStreamTooManyIsRefusedUntilAnotherEnds) {
  ServerOptions options = TestOptions();
  options.quotas.max_streams = 2;
  StartServer(options);
  Uploader first(*mapping_, "mine", {"anna", "run1"});
  Uploader second(*mapping_, "mine", {"anna", "run2"});
  ASSERT_TRUE(first.Read().has_ready());
  ASSERT_TRUE(second.Read().has_ready());
  Uploader third(*mapping_, "mine", {"anna", "run3"});
  const absl::Status refused = FromGrpcStatus(third.End());
  EXPECT_EQ(refused.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(QuotaSubjectOf(refused), "robot/anna/streams");
  EXPECT_TRUE(Uploader(*mapping_, "mine", {"bert", "run1"}).Read().has_ready());
  ASSERT_TRUE(first.Close().ok());
  // The client hears of the end a moment before the server is done with the stream.
  const auto deadline = testing::Deadline();
  bool opened = false;
  while (!opened && std::chrono::system_clock::now() < deadline) {
    opened = Uploader(*mapping_, "mine", {"anna", "run3"}).Read().has_ready();
  }
  EXPECT_TRUE(opened);
}

TEST_F(QuotaRefusalsTest, WatchesCountAsStreams) {
  ServerOptions options = TestOptions();
  options.quotas.max_streams = 1;
  StartServer(options);
  testing::Watcher first(*mapping_, testing::WatchRequest("mine"));
  v1::WatchGraphResponse frame;
  ASSERT_TRUE(first.Read(frame));
  const absl::Status refused =
      FromGrpcStatus(testing::Watcher(*mapping_, testing::WatchRequest("mine")).Finish());
  EXPECT_EQ(refused.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(QuotaSubjectOf(refused).value_or(""), EndsWith("/streams"));
}

// 19 submaps at 10 messages a second after a burst of 10 (the header is the connection's, not yet
// the robot's): nothing is refused, only read later.
TEST_F(QuotaRefusalsTest, AnUploadOverItsRateIsSlowedAndAllOfItAcknowledged) {
  ServerOptions options = TestOptions();
  options.quotas.max_messages_per_s = 10;
  options.quotas.messages_burst = 10;
  StartServer(options);
  const auto begin = std::chrono::steady_clock::now();
  Uploader uploader(*mapping_, "mine", kAnna);
  ASSERT_TRUE(uploader.Read().has_ready());
  for (int i = 0; i < 19; ++i) {
    ASSERT_EQ(uploader.Send(MakeSubmap(i, i, 1)).ack().durable_through_sequence(), i);
  }
  // The last was read when the debts of those before it were paid.
  EXPECT_GE(std::chrono::steady_clock::now() - begin, std::chrono::milliseconds(800));
  EXPECT_TRUE(uploader.Close().ok());
}

// It ends although its next read is minutes away.
TEST_F(QuotaRefusalsTest, AServerWithASlowedUploadShutsDown) {
  ServerOptions options = TestOptions();
  options.quotas.max_messages_per_s = 0.001;
  options.quotas.messages_burst = 1;
  StartServer(options);
  Uploader uploader(*mapping_, "mine", kAnna);
  ASSERT_TRUE(uploader.Read().has_ready());
  server_->Shutdown(absl::InfiniteDuration());
  EXPECT_EQ(uploader.End().error_code(), grpc::StatusCode::UNAVAILABLE);
}

struct MapLimit {
  std::string message;
  void (*set)(ServerLimits&);
};
class MapLimitTest : public ServerTest, public ::testing::WithParamInterface<int> {
 protected:
  void SetUp() override {}
};

const MapLimit kMapLimits[] = {
    {"sequence: the map may have 3 submaps", [](ServerLimits& l) { l.max_submaps_per_map = 3; }},
    {"keyframes: the map may have 35", [](ServerLimits& l) { l.max_keyframes_per_map = 35; }},
};

// Two missions share the map's quota; deleting is what makes room.
TEST_P(MapLimitTest, TheMapIsFullForEveryMissionAndOtherMapsAreNot) {
  const MapLimit& limit = kMapLimits[GetParam()];
  ServerOptions options = TestOptions();
  limit.set(options.limits);
  StartServer(options);
  Upload("mine", {"anna", "run1"}, 2, 10);
  Uploader bert(*mapping_, "mine", {"bert", "run1"});
  ASSERT_TRUE(bert.Read().has_ready());
  ASSERT_TRUE(bert.Send(MakeSubmap(0, 0, 10)).has_ack());
  const auto answer = bert.Send(MakeSubmap(1, 10, 10));
  EXPECT_EQ(answer.reject().code(), static_cast<int>(absl::StatusCode::kResourceExhausted));
  EXPECT_THAT(answer.reject().message(), HasSubstr(limit.message));
  Upload("other", {"anna", "run1"}, 1, 10);
}

INSTANTIATE_TEST_SUITE_P(All, MapLimitTest, ::testing::Values(0, 1));

TEST_F(QuotaRefusalsTest, AMapKeepsOnlySoManyClouds) {
  ServerOptions options = TestOptions();
  options.limits.max_blobs_per_map = 1;
  StartServer(options);
  const std::vector<std::string> blobs = {testing::EncodedCloud(1), testing::EncodedCloud(2)};
  Uploader uploader(*mapping_, "mine", kAnna);
  uploader.Read();
  ASSERT_TRUE(uploader.Send(testing::MakeSubmapWithClouds(0, 0, 2, blobs)).has_ack());
  ASSERT_EQ(uploader.Read().want().sha256_size(), 2);
  std::vector<int> codes;
  for (const std::string& blob : blobs) {
    v1::BlobChunk chunk;
    chunk.set_sha256(Sha256(blob));
    chunk.set_data(blob);
    uploader.Write(chunk);
    codes.push_back(uploader.Read().blob_result().code());
  }
  EXPECT_EQ(codes[0], 0);
  EXPECT_EQ(codes[1], static_cast<int>(absl::StatusCode::kResourceExhausted));
}

}  // namespace
}  // namespace overtone
