// SPDX-License-Identifier: Apache-2.0
// What peers see of a server that shuts down, and of streams that reach their age.
#include <unistd.h>

#include <filesystem>
#include <string>

#include "gtest/gtest.h"
#include "overtone/proto/conversion/status_conversion.h"
#include "overtone/tests/services/mapping_server/server_fixture.h"

namespace overtone {
namespace {

using testing::MakeSubmap;
using testing::ServerTest;
using testing::TestOptions;
using testing::Uploader;

const MissionId kAnna = {"anna", "run1"};

v1::UploadSubmapsRequest SubmapFrame(int i) {
  v1::UploadSubmapsRequest request;
  *request.mutable_submap() = ToProto(MakeSubmap(i, i, 1));
  return request;
}

class DrainTest : public ServerTest {
 protected:
  void SetUp() override {
    folder_ = ::testing::TempDir() + "drain_" + std::to_string(getpid());
    std::filesystem::remove_all(folder_);
  }
  void TearDown() override {
    server_.reset();
    std::filesystem::remove_all(folder_);
  }
  // On disk, so that submaps are on their way for a while.
  ServerOptions Options() const {
    ServerOptions options = TestOptions();
    options.data_dir = folder_;
    return options;
  }

  std::string folder_;
};

// Else the robot sends again what is stored already; never the other way round.
TEST_F(DrainTest, AnUploadEndsWhenAllThatWasReadIsAcknowledged) {
  constexpr int kRounds = 8;
  int last_round_stored = 0;
  for (int round = 0; round < kRounds; ++round) {
    StartServer(Options());
    const MissionId mission = {"anna", "run" + std::to_string(round)};
    int64_t acknowledged = -1;
    {
      Uploader uploader(*mapping_, "mine", mission);
      ASSERT_TRUE(uploader.Read().has_ready());
      for (int i = 0; i < 100; ++i) uploader.Write(SubmapFrame(i));
      acknowledged = uploader.Read().ack().durable_through_sequence();
      server_->Shutdown(absl::Seconds(20));
      for (auto answer = uploader.Read(); answer.has_ack(); answer = uploader.Read()) {
        acknowledged = answer.ack().durable_through_sequence();
      }
      EXPECT_EQ(uploader.End().error_code(), grpc::StatusCode::UNAVAILABLE);
    }
    server_.reset();
    StartServer(Options());
    EXPECT_EQ(UploadState("mine", mission).next_sequence(), acknowledged + 1) << "round " << round;
    last_round_stored = static_cast<int>(acknowledged) + 1;
    server_.reset();
  }
  EXPECT_GT(last_round_stored, 0);
}

TEST_F(DrainTest, AStreamThatReachesItsAgeIsAnsweredInFullAndToldToComeBackAtOnce) {
  ServerOptions options = Options();
  options.limits.max_connection_age_s = 0.3;
  StartServer(options);
  testing::Watcher watcher(*mapping_, testing::WatchRequest("mine"));
  Uploader uploader(*mapping_, "mine", kAnna);
  ASSERT_TRUE(uploader.Read().has_ready());
  int64_t acknowledged = -1;
  for (int i = 0; acknowledged == i - 1; ++i) {
    const auto answer = uploader.Send(MakeSubmap(i, i, 1));
    if (answer.has_ack()) acknowledged = answer.ack().durable_through_sequence();
  }
  for (const grpc::Status& end : {uploader.End(), watcher.Finish()}) {
    EXPECT_EQ(end.error_code(), grpc::StatusCode::UNAVAILABLE) << end.error_message();
    EXPECT_EQ(RetryDelayOf(FromGrpcStatus(end)), absl::ZeroDuration());
  }
  EXPECT_EQ(UploadState("mine", kAnna).next_sequence(), acknowledged + 1);
}

}  // namespace
}  // namespace overtone
