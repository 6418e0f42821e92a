// SPDX-License-Identifier: Apache-2.0
// `overtone backup`, `restore`, `verify` and `delete` as an operator runs them, on a server process
// with a data directory, while a real client uploads.
#include <unistd.h>

#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "absl/time/clock.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/client/cli/admin_client.h"
#include "overtone/client/cli/child_process.h"
#include "overtone/client/cli/server_process.h"
#include "overtone/client/mapping_client.h"
#include "overtone/tests/support/fake_host.h"
#include "overtone/tests/support/straight_mission.h"

namespace overtone {
namespace {

using ::testing::HasSubstr;

constexpr absl::Duration kPatience = absl::Seconds(60);
constexpr int kSubmapsBefore = 5;
constexpr int kSubmaps = 40;

class MapBackupTest : public ::testing::Test {
 protected:
  MapBackupTest() {
    folder_ = ::testing::TempDir() + "map_backup_" + std::to_string(getpid());
    std::filesystem::create_directories(folder_);
  }
  ~MapBackupTest() override {
    server_.reset();
    std::filesystem::remove_all(folder_);
  }
  void SetUp() override { StartServer(); }

  void StartServer() {
    server_.reset();
    auto server = ServerProcess::Start(OVERTONE_SERVER, {"--data-dir", folder_ + "/data"},
                                       folder_ + "/server.log", [] { return absl::OkStatus(); });
    ASSERT_TRUE(server.ok()) << server.status();
    server_ = *std::move(server);
  }

  std::unique_ptr<MappingClient> Connect(FakeHost* host) {
    MappingClientOptions options;
    options.server = server_->address();
    options.map = "town";
    options.mission = TestMission();
    options.min_time_between_comparisons = absl::InfiniteDuration();
    auto client = MappingClient::Create(options, host);
    EXPECT_TRUE(client.ok()) << client.status();
    return client.ok() ? *std::move(client) : nullptr;
  }

  // How `overtone ARGUMENTS` ends, and all that it prints.
  std::string Run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), OVERTONE_PROGRAM);
    arguments.insert(arguments.end(), {"--server", server_->address()});
    auto child = ChildProcess::Start({"overtone", arguments, folder_ + "/stderr.txt"});
    if (!child.ok()) return child.status().ToString();
    std::string text;
    for (;;) {
      const auto line = (*child)->ReadLine(kPatience, [] { return absl::OkStatus(); });
      if (!line.ok()) return text + std::string(line.status().message());
      text += *line + "\n";
    }
  }

  // When its newest revision holds all that came: the server says so only when it is asked.
  std::vector<v1::Node> Trajectory(const std::string& map) {
    AdminClient admin(server_->address(), kPatience);
    const absl::Time deadline = absl::Now() + kPatience;
    for (bool settled = false; !settled && absl::Now() < deadline;) {
      absl::SleepFor(absl::Milliseconds(50));
      const auto summary = admin.GetMap(map);
      EXPECT_TRUE(summary.ok()) << summary.status();
      settled = !summary.ok() || summary->front_end_backlog() == 0;
    }
    const auto response = admin.GetTrajectory(map, TestMission());
    EXPECT_TRUE(response.ok()) << response.status();
    if (!response.ok()) return {};
    return {response->nodes().begin(), response->nodes().end()};
  }

  std::string folder_;
  std::unique_ptr<ServerProcess> server_;
};

TEST_F(MapBackupTest, ABackupTakenDuringAnUploadIsAMapOfItsOwn) {
  FakeHost host;
  const auto client = Connect(&host);
  ASSERT_NE(client, nullptr);
  for (int64_t i = 0; i < kSubmapsBefore; ++i) {
    ASSERT_TRUE(client->AddSubmap(WithClouds(StraightSubmap(i), 10, 3000)).ok());
  }
  ASSERT_TRUE(client->WaitUntilAcknowledged(kPatience).ok());
  std::thread robot([&] {
    for (int64_t i = kSubmapsBefore; i < kSubmaps; ++i) {
      EXPECT_TRUE(client->AddSubmap(WithClouds(StraightSubmap(i), 10, 3000)).ok());
    }
    EXPECT_TRUE(client->WaitUntilAcknowledged(kPatience).ok());
  });
  const std::string file = folder_ + "/town.backup";
  EXPECT_THAT(Run({"backup", "--map", "town", "--output", file}), HasSubstr("exit code 0"));
  robot.join();
  EXPECT_THAT(Run({"restore", "--map", "copy", file}), HasSubstr("exit code 0"));
  for (const char* map : {"town", "copy"}) {
    const std::string verified = Run({"verify", "--map", map});
    EXPECT_THAT(verified, HasSubstr("all is whole"));
    EXPECT_THAT(verified, HasSubstr("exit code 0"));
    std::printf("%s", verified.c_str());
  }

  // Whole submaps from the first on, and all that was acknowledged before it began.
  const std::vector<v1::Node> town = Trajectory("town"), copy = Trajectory("copy");
  ASSERT_GE(copy.size(), 10u * kSubmapsBefore);
  ASSERT_LE(copy.size(), town.size());
  EXPECT_EQ(copy.size() % 10, 0);
  for (size_t i = 0; i < copy.size(); ++i) {
    EXPECT_EQ(copy[i].stamp_ns(), town[i].stamp_ns());
    EXPECT_NEAR(copy[i].map_tform_body().position().x(), town[i].map_tform_body().position().x(),
                1e-6);
  }
  std::printf("%zu of %zu keyframes are in the backup\n", copy.size(), town.size());

  // All of it again after a restart; then one goes and the other stays.
  StartServer();
  EXPECT_EQ(Trajectory("copy").size(), copy.size());
  EXPECT_THAT(Run({"delete", "--map", "town", "--yes"}), HasSubstr("exit code 0"));
  EXPECT_FALSE(std::filesystem::exists(folder_ + "/data/maps/town"));
  EXPECT_THAT(Run({"verify", "--map", "town"}), HasSubstr("exit code 2"));
  EXPECT_EQ(Trajectory("copy").size(), copy.size());
}

}  // namespace
}  // namespace overtone
