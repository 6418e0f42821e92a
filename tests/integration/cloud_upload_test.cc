// SPDX-License-Identifier: Apache-2.0
// Clouds from a real client to a real server in a process of its own, over a link that breaks.
#include <unistd.h>

#include <memory>
#include <string>

#include "gtest/gtest.h"
#include "overtone/client/cli/admin_client.h"
#include "overtone/client/cli/server_process.h"
#include "overtone/client/mapping_client.h"
#include "overtone/tests/support/fake_host.h"
#include "overtone/tests/support/faulty_link.h"
#include "overtone/tests/support/straight_mission.h"

namespace overtone {
namespace {

constexpr absl::Duration kPatience = absl::Seconds(60);
constexpr int kSubmaps = 5;
constexpr int kClouds = 50;  // one for each keyframe

std::unique_ptr<MappingClient> Connect(const std::string& address, const MissionId& mission,
                                       FakeHost* host) {
  MappingClientOptions options;
  options.server = address;
  options.map = "town";
  options.mission = mission;
  options.initial_backoff = absl::Milliseconds(5);
  options.max_backoff = absl::Milliseconds(50);
  options.min_time_between_comparisons = absl::InfiniteDuration();
  auto client = MappingClient::Create(options, host);
  EXPECT_TRUE(client.ok()) << client.status();
  return client.ok() ? *std::move(client) : nullptr;
}

LinkConditions ResetAfter(int64_t bytes) {
  LinkConditions conditions;
  conditions.reset_after_bytes = bytes;
  return conditions;
}

void Upload(MappingClient& client) {
  for (int64_t i = 0; i < kSubmaps; ++i) {
    const absl::Status status = client.AddSubmap(WithClouds(StraightSubmap(i), 10, 3000));
    ASSERT_TRUE(status.ok()) << status;
  }
  const absl::Status status = client.WaitUntilAcknowledged(kPatience);
  EXPECT_TRUE(status.ok()) << status;
}

class CloudUploadTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::string log = ::testing::TempDir() + "cloud_upload_" + std::to_string(getpid());
    auto server = ServerProcess::Start(OVERTONE_SERVER, {}, log, [] { return absl::OkStatus(); });
    ASSERT_TRUE(server.ok()) << server.status();
    server_ = *std::move(server);
  }

  void ExpectClouds(int64_t clouds) {
    const auto map = AdminClient(server_->address(), kPatience).GetMap("town");
    ASSERT_TRUE(map.ok()) << map.status();
    EXPECT_EQ(map->clouds(), clouds);
    EXPECT_EQ(map->missing_blobs(), 0);
  }

  std::unique_ptr<ServerProcess> server_;
};

TEST_F(CloudUploadTest, EveryCloudArrivesOnceThroughAConnectionThatIsCut) {
  FaultyLink link(server_->address());
  link.Set(ResetAfter(200'000));
  FakeHost host;
  const auto client = Connect(link.address(), TestMission(), &host);
  ASSERT_NE(client, nullptr);
  Upload(*client);
  ExpectClouds(kClouds);
  const MappingClientStats stats = client->Stats();
  EXPECT_GE(link.connections(), 2);
  EXPECT_EQ(stats.submaps_acknowledged, kSubmaps);
  EXPECT_EQ(stats.blobs_waiting, 0);
  EXPECT_EQ(stats.clouds_dropped, 0);
  EXPECT_GT(stats.bytes_sent, 400'000);
  std::printf("%ld bytes sent, %ld connections\n", stats.bytes_sent, link.connections());
}

TEST_F(CloudUploadTest, WhatAnotherMissionSentIsNotSentAgain) {
  FakeHost host;
  const auto first = Connect(server_->address(), TestMission(), &host);
  ASSERT_NE(first, nullptr);
  Upload(*first);
  const auto second = Connect(server_->address(), {"robot_b", "run_1"}, &host);
  ASSERT_NE(second, nullptr);
  Upload(*second);
  ExpectClouds(2 * kClouds);
  EXPECT_LT(second->Stats().bytes_sent, first->Stats().bytes_sent / 10);
}

// Its first client ends with clouds still under way; the second has none of them before the host
// hands them over.
TEST_F(CloudUploadTest, ARobotThatStartsOverLosesNoCloud) {
  FakeHost host;
  {
    FaultyLink link(server_->address());
    link.Set(ResetAfter(200'000));
    const auto client = Connect(link.address(), TestMission(), &host);
    ASSERT_NE(client, nullptr);
    for (int64_t i = 0; i < kSubmaps; ++i) {
      ASSERT_TRUE(client->AddSubmap(WithClouds(StraightSubmap(i), 10, 3000)).ok());
    }
  }
  const auto client = Connect(server_->address(), TestMission(), &host);
  ASSERT_NE(client, nullptr);
  Upload(*client);
  ExpectClouds(kClouds);
  EXPECT_EQ(client->Stats().clouds_dropped, 0);
}

}  // namespace
}  // namespace overtone
