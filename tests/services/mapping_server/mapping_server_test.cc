// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/mapping_server.h"

#include <string>

#include "absl/strings/str_cat.h"
#include "gmock/gmock.h"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "grpcpp/generic/generic_stub.h"
#include "gtest/gtest.h"
#include "overtone/tests/services/mapping_server/server_fixture.h"

namespace overtone {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::MakeClosure;
using testing::ServerTest;
using ::testing::StartsWith;
using testing::TestOptions;
using testing::Uploader;
using testing::Watcher;
using testing::WatchRequest;

const MissionId kAnna = {"anna", "run1"};

class MappingServerTest : public ServerTest {
 protected:
  // A unary call with raw bytes, for services that this test has no stubs of.
  grpc::Status CallRaw(const std::string& method, const std::string& request,
                       std::string& response) {
    grpc::GenericStub stub(
        grpc::CreateChannel(server_->address(), grpc::InsecureChannelCredentials()));
    grpc::ClientContext context;
    context.set_deadline(testing::Deadline());
    grpc::CompletionQueue queue;
    const grpc::Slice slice(request);
    const grpc::ByteBuffer bytes(&slice, 1);
    grpc::ByteBuffer answer;
    grpc::Status status;
    auto call = stub.PrepareUnaryCall(&context, method, bytes, &queue);
    call->StartCall();
    call->Finish(&answer, &status, this);
    void* tag = nullptr;
    bool ok = false;
    queue.Next(&tag, &ok);
    grpc::Slice whole;
    if (answer.Valid() && answer.DumpToSingleSlice(&whole).ok()) {
      response.assign(reinterpret_cast<const char*>(whole.begin()), whole.size());
    }
    return status;
  }
};

TEST_F(MappingServerTest, SaysWhatItIs) {
  v1::GetServerInfoResponse response;
  grpc::ClientContext context;
  ASSERT_TRUE(mapping_->GetServerInfo(&context, {}, &response).ok());
  EXPECT_EQ(response.protocol(), "overtone.v1");
  EXPECT_THAT(response.features(),
              ElementsAre("compact", "delta", "kron_reduction", "clouds", "landmarks"));
  EXPECT_EQ(response.limits().max_message_bytes(), 4 << 20);
  EXPECT_EQ(response.limits().max_keyframes_per_submap(), 2000);
}

TEST_F(MappingServerTest, HealthIsReportedForEachService) {
  const std::string serving("\x08\x01", 2);  // HealthCheckResponse{status: SERVING}
  for (const std::string service : {"overtone.v1.MappingService", "overtone.v1.MapAdminService"}) {
    const std::string request = absl::StrCat("\x0a", std::string(1, service.size()), service);
    std::string response;
    EXPECT_TRUE(CallRaw("/grpc.health.v1.Health/Check", request, response).ok());
    EXPECT_EQ(response, serving) << service;
  }
}

TEST_F(MappingServerTest, ReflectionCanBeSwitchedOff) {
  const std::string method = "/grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo";
  const std::string list_services("\x3a\x01*", 3);
  std::string response;
  EXPECT_TRUE(CallRaw(method, list_services, response).ok());
  EXPECT_THAT(response, HasSubstr("overtone.v1.MappingService"));
  ServerOptions options = TestOptions();
  options.reflection = false;
  StartServer(options);
  EXPECT_EQ(CallRaw(method, list_services, response).error_code(), grpc::StatusCode::UNIMPLEMENTED);
}

TEST_F(MappingServerTest, ShutdownEndsOpenStreamsWithUnavailableAndDoesNotHang) {
  Upload("mine", kAnna, 1, 5);
  Uploader uploader(*mapping_, "mine", kAnna);
  ASSERT_TRUE(uploader.Read().has_ready());
  Watcher watcher(*mapping_, WatchRequest("mine"));
  ASSERT_TRUE(watcher.ReadGraph().has_snapshot());
  Watcher waiting(*mapping_, WatchRequest("other"));
  v1::WatchGraphResponse frame;
  ASSERT_TRUE(waiting.Read(frame));
  server_->Shutdown(absl::Seconds(20));
  EXPECT_EQ(uploader.End().error_code(), grpc::StatusCode::UNAVAILABLE);
  EXPECT_EQ(watcher.Finish().error_code(), grpc::StatusCode::UNAVAILABLE);
  EXPECT_EQ(waiting.Finish().error_code(), grpc::StatusCode::UNAVAILABLE);
}

TEST_F(MappingServerTest, APortInUseIsAnError) {
  ServerOptions options = TestOptions();
  options.listen = server_->address();
  EXPECT_EQ(MappingServer::Start(options).status().code(), absl::StatusCode::kUnavailable);
}

TEST_F(MappingServerTest, InvalidOptionsAreNamed) {
  ServerOptions options = TestOptions();
  options.publisher.heartbeat_s = -1;
  const absl::Status status = MappingServer::Start(options).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(status.message()), StartsWith("publisher.heartbeat_s:"));
}

TEST_F(MappingServerTest, BytesThatAreNoMessageAreRefusedAndTheServerLives) {
  for (const std::string method : {"GetServerInfo", "GetUploadState", "AddLoopClosures",
                                   "WatchGraph", "GetGraph", "UploadSubmaps"}) {
    std::string response;
    const grpc::Status status =
        CallRaw("/overtone.v1.MappingService/" + method, "\xff\xff\xff\xff\x01", response);
    EXPECT_FALSE(status.ok()) << method;
  }
  Upload("mine", kAnna, 1, 5);
}

TEST_F(MappingServerTest, BadLoopClosuresAreRefusedAllTogether) {
  Upload("mine", kAnna, 1, 5);
  v1::AddLoopClosuresRequest request;
  request.set_map("mine");
  *request.add_loop_closures() = ToProto(MakeClosure({kAnna, 1}, {kAnna, 4}));
  v1::LoopClosure& bad = *request.add_loop_closures();
  bad = ToProto(MakeClosure({kAnna, 0}, {kAnna, 4}));
  bad.mutable_from_tform_to()->mutable_orientation()->set_x(7);
  v1::AddLoopClosuresResponse response;
  const auto call = [&] {
    grpc::ClientContext context;
    return mapping_->AddLoopClosures(&context, request, &response);
  };
  grpc::Status status = call();
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(status.error_message(), StartsWith("loop_closures[1].from_tform_to.orientation:"));
  google::rpc::Status details;
  ASSERT_TRUE(details.ParseFromString(status.error_details()));
  google::rpc::BadRequest bad_request;
  ASSERT_TRUE(details.details(1).UnpackTo(&bad_request));
  EXPECT_EQ(bad_request.field_violations(0).field(), "loop_closures[1].from_tform_to.orientation");

  request.mutable_loop_closures()->RemoveLast();
  status = call();
  EXPECT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(response.added(), 1);  // the first one was not kept before
  request.clear_loop_closures();
  EXPECT_THAT(call().error_message(), StartsWith("loop_closures:"));
  request.set_map("nowhere");
  EXPECT_EQ(call().error_code(), grpc::StatusCode::NOT_FOUND);
}

}  // namespace
}  // namespace overtone
