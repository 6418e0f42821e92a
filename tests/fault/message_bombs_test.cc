// SPDX-License-Identifier: Apache-2.0
// Messages that are small on the wire and large in memory, many at once.
#include <cstdio>
#include <string>
#include <thread>
#include <vector>

#include "grpcpp/impl/codegen/client_unary_call.h"
#include "gtest/gtest.h"
#include "overtone/proto/conversion/limits.h"
#include "overtone/tests/fault/fault_server.h"
#include "overtone/tests/support/plain_peers.h"

namespace overtone {
namespace {

using testing::Deadline;
using testing::FaultServer;
using testing::Uploader;

constexpr int kAtOnce = 32;

// Two bytes each on the wire.
v1::UploadSubmapsRequest EmptyKeyframes() {
  v1::UploadSubmapsRequest request;
  for (int64_t bytes = 64; bytes < limits::kMaxSubmapBytes; bytes += 2) {
    request.mutable_submap()->add_keyframes();
  }
  return request;
}

class MessageBombsTest : public ::testing::Test {
 protected:
  // What `attack`, once from each of many connections at the same time, takes of the server's
  // memory at most, MiB.
  template <typename Attack>
  double Cost(const char* name, Attack attack) {
    attack(0);
    const double before = server_.ResidentMebibytes();
    std::vector<std::thread> threads;
    for (int i = 0; i < kAtOnce; ++i) threads.emplace_back(attack, i);
    for (std::thread& thread : threads) thread.join();
    const double cost = server_.PeakMebibytes() - before;
    std::printf("%d x %-16s %+.1f MiB at most, on %.1f\n", kAtOnce, name, cost, before);
    return cost;
  }

  FaultServer server_{"message_bombs", "log_level: warning\n"};
};

TEST_F(MessageBombsTest, EmptyKeyframesAreNotKeptOnceTheyAreRefused) {
  const v1::UploadSubmapsRequest bomb = EmptyKeyframes();
  const double cost = Cost("keyframes", [&](int i) {
    const auto stub = server_.Connect();
    const MissionId mission = {"robot" + std::to_string(i), "run1"};
    Uploader uploader(*stub, "mine", mission);
    ASSERT_TRUE(uploader.Read().has_ready());
    for (int again = 0; again < 3; ++again) {
      ASSERT_TRUE(uploader.Write(bomb));
      EXPECT_EQ(uploader.Read().reject().message().substr(0, 17), "submap.keyframes:");
    }
  });
  // One takes about 80 MiB decoded; as many as the server has threads are decoded at once.
  EXPECT_LE(cost, 640);
}

TEST_F(MessageBombsTest, EmptyLoopClosuresAreNotKeptOnceTheyAreRefused) {
  v1::AddLoopClosuresRequest bomb;
  bomb.set_map("mine");
  for (int64_t bytes = 64; bytes < limits::kMaxSubmapBytes; bytes += 2) bomb.add_loop_closures();
  const double cost = Cost("loop closures", [&](int) {
    const auto stub = server_.Connect();
    grpc::ClientContext context;
    context.set_deadline(Deadline());
    v1::AddLoopClosuresResponse response;
    EXPECT_FALSE(stub->AddLoopClosures(&context, bomb, &response).ok());
  });
  EXPECT_LE(cost, 640);
}

TEST_F(MessageBombsTest, AMessageAboveTheLargestRequestIsNeverDecoded) {
  v1::UploadSubmapsRequest bomb;
  for (int i = 0; i < (3 << 20); i += 2) bomb.mutable_submap()->add_keyframes();
  const double cost = Cost("too large", [&](int i) {
    const auto stub = server_.Connect();
    const MissionId mission = {"robot" + std::to_string(i), "run1"};
    Uploader uploader(*stub, "mine", mission);
    ASSERT_TRUE(uploader.Read().has_ready());
    uploader.Write(bomb);
    EXPECT_EQ(uploader.End().error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  });
  EXPECT_LE(cost, 64);
}

// Groups within groups: protobuf's own limit of a hundred.
TEST_F(MessageBombsTest, NestingWithoutEndIsRefused) {
  const std::string groups(1 << 20, '\x0b');  // field 1, start of a group
  const grpc::Slice slice(groups);
  const grpc::ByteBuffer request(&slice, 1);
  grpc::ByteBuffer response;
  grpc::ClientContext context;
  context.set_deadline(Deadline());
  const auto channel =
      grpc::CreateChannel(server_.process().address(), grpc::InsecureChannelCredentials());
  const grpc::internal::RpcMethod method("/overtone.v1.MappingService/GetGraph",
                                         grpc::internal::RpcMethod::NORMAL_RPC);
  const grpc::Status status = grpc::internal::BlockingUnaryCall<grpc::ByteBuffer, grpc::ByteBuffer>(
      channel.get(), method, &context, request, &response);
  EXPECT_FALSE(status.ok());
  EXPECT_TRUE(server_.process().CheckAlive().ok());
}

}  // namespace
}  // namespace overtone
