// SPDX-License-Identifier: Apache-2.0
// The client with its outbox on disk, over restarts of its own, of the server and of both.
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "absl/synchronization/mutex.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/client/mapping_client.h"
#include "overtone/tests/support/fake_host.h"
#include "overtone/tests/support/scripted_mapping_server.h"
#include "overtone/tests/support/straight_mission.h"
#include "overtone/tests/support/temporary_directory.h"

namespace overtone {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using Upload = ScriptedMappingServer::Upload;

constexpr absl::Duration kPatience = absl::Seconds(20);
constexpr char kNowhere[] = "127.0.0.1:1";

class MappingClientRestartTest : public ::testing::Test {
 protected:
  MappingClientOptions Options(const std::string& address, const std::string& mission = "run_1") {
    MappingClientOptions options;
    options.server = address;
    options.map = "town";
    options.mission = {"robot_a", mission};
    options.outbox_dir = directory_.File("outbox");
    options.initial_backoff = absl::Milliseconds(2);
    options.max_backoff = absl::Milliseconds(50);
    options.min_time_between_comparisons = absl::InfiniteDuration();
    options.log = [this](LogLevel, absl::string_view line) {
      absl::MutexLock lock(&mutex_);
      log_.emplace_back(line);
    };
    return options;
  }

  std::unique_ptr<MappingClient> Connect(const MappingClientOptions& options) {
    auto client = MappingClient::Create(options, &host_);
    EXPECT_TRUE(client.ok()) << client.status();
    return client.ok() ? *std::move(client) : nullptr;
  }

  // What the first `count` submaps of a mission leave behind when the server is away.
  void LeaveBehind(const std::string& mission, int64_t count) {
    const auto client = Connect(Options(kNowhere, mission));
    for (int64_t i = 0; i < count; ++i) {
      ASSERT_TRUE(client->AddSubmap(WithClouds(StraightSubmap(i), 2)).ok());
    }
    ASSERT_TRUE(client->WaitUntilPersisted(kPatience).ok());
    EXPECT_EQ(client->Stats().persisted_through, count - 1);
  }

  std::vector<std::string> Files() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(directory_.File("outbox"))) {
      names.push_back(entry.path().filename());
    }
    return names;
  }
  std::vector<std::string> Log() {
    absl::MutexLock lock(&mutex_);
    return log_;
  }

  TemporaryDirectory directory_;
  FakeHost host_;

 private:
  absl::Mutex mutex_;
  std::vector<std::string> log_ ABSL_GUARDED_BY(mutex_);
};

// What a server has of each mission, over all its lives.
class TownServer {
 public:
  struct Mission {
    int64_t next = 0;
    std::vector<int64_t> stored;
  };

  ScriptedMappingServer server{{[this](int, Upload& upload) { return Serve(upload); }}};

  Mission mission(const std::string& name) {
    absl::MutexLock lock(&mutex_);
    return missions_[name];
  }

 private:
  grpc::Status Serve(Upload& upload) {
    const std::string name = upload.header().mission().mission();
    upload.Ready(mission(name).next);
    return upload.AcknowledgeEverything([&](const v1::Submap& submap) {
      absl::MutexLock lock(&mutex_);
      Mission& mission = missions_[name];
      mission.stored.push_back(submap.sequence());
      mission.next = submap.sequence() + 1;
    });
  }

  absl::Mutex mutex_;
  std::map<std::string, Mission> missions_ ABSL_GUARDED_BY(mutex_);
};

TEST_F(MappingClientRestartTest, TheSameMissionGoesOn) {
  LeaveBehind("run_1", 3);
  TownServer town;
  {
    const auto client = Connect(Options(town.server.address()));
    EXPECT_EQ(client->NextSubmap().sequence, 3);
    EXPECT_EQ(client->NextSubmap().first_index, 30);
    EXPECT_EQ(client->AddSubmap(StraightSubmap(0)).code(), absl::StatusCode::kOutOfRange);
    Submap back_in_time = StraightSubmap(3);
    for (Keyframe& keyframe : back_in_time.keyframes) keyframe.stamp.ns -= 10'000'000'000;
    EXPECT_EQ(client->AddSubmap(back_in_time).code(), absl::StatusCode::kInvalidArgument);
    ASSERT_TRUE(client->AddSubmap(StraightSubmap(3)).ok());
    ASSERT_TRUE(client->WaitUntilAcknowledged(kPatience).ok());
  }
  EXPECT_THAT(town.mission("run_1").stored, ElementsAre(0, 1, 2, 3));
  EXPECT_EQ(town.server.Blobs().size(), 6u);
  const auto client = Connect(Options(town.server.address()));
  EXPECT_EQ(client->NextSubmap().sequence, 4);
  EXPECT_EQ(client->Stats().submaps_waiting, 0);
}

TEST_F(MappingClientRestartTest, EarlierMissionsGoUpAndTheirFilesGo) {
  LeaveBehind("run_1", 3);
  LeaveBehind("run_2", 2);
  TownServer town;
  const auto client = Connect(Options(town.server.address(), "run_3"));
  ASSERT_TRUE(client->AddSubmap(StraightSubmap(0)).ok());
  ASSERT_TRUE(client->WaitUntilAcknowledged(kPatience).ok());
  const absl::Time deadline = absl::Now() + kPatience;
  while (client->Stats().missions_waiting > 0 && absl::Now() < deadline) std::this_thread::yield();
  EXPECT_EQ(client->Stats().missions_waiting, 0);
  EXPECT_THAT(town.mission("run_1").stored, ElementsAre(0, 1, 2));
  EXPECT_THAT(town.mission("run_2").stored, ElementsAre(0, 1));
  EXPECT_THAT(town.mission("run_3").stored, ElementsAre(0));
  EXPECT_EQ(town.server.Blobs().size(), 10u);
  for (const std::string& name : Files()) EXPECT_THAT(name, HasSubstr("run_3"));
}

TEST_F(MappingClientRestartTest, AnotherRobotsOutboxIsNotTouched) {
  {
    MappingClientOptions other = Options(kNowhere);
    other.mission.robot = "robot_b";
    const auto client = Connect(other);
    ASSERT_TRUE(client->AddSubmap(StraightSubmap(0)).ok());
  }
  TownServer town;
  const auto client = Connect(Options(town.server.address()));
  EXPECT_EQ(client->Stats().missions_waiting, 0);
  EXPECT_THAT(Files(), Contains("town.robot_b.run_1.outbox"));
}

TEST_F(MappingClientRestartTest, AnEarlierMissionThatIsRefusedIsKeptAside) {
  LeaveBehind("run_1", 3);
  LeaveBehind("run_2", 1);
  ScriptedMappingServer server({[](int, Upload& upload) {
    upload.Ready(0);
    if (upload.header().mission().mission() != "run_1") return upload.AcknowledgeEverything();
    upload.Reject(upload.Read(), grpc::StatusCode::PERMISSION_DENIED, "mission: not yours");
    while (upload.Read() >= 0) {
    }
    return grpc::Status::OK;
  }});
  {
    const auto client = Connect(Options(server.address(), "run_3"));
    const absl::Time deadline = absl::Now() + kPatience;
    while (client->Stats().missions_waiting > 0 && absl::Now() < deadline) {
      std::this_thread::yield();
    }
  }
  EXPECT_THAT(Files(), Contains("town.robot_a.run_1.outbox.refused"));
  EXPECT_THAT(Log(), Contains(HasSubstr("not yours")));
  absl::MutexLock lock(&host_.mutex);
  EXPECT_TRUE(host_.rejected.empty());  // not of the current mission
}

TEST_F(MappingClientRestartTest, TwoClientsOfOneMissionAreOneTooMany) {
  const auto first = Connect(Options(kNowhere));
  const auto second = MappingClient::Create(Options(kNowhere), &host_);
  EXPECT_EQ(second.status().code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(second.status().message()), HasSubstr("in use"));
}

TEST_F(MappingClientRestartTest, ADirectoryThatCannotBeIsNamed) {
  MappingClientOptions options = Options(kNowhere);
  options.outbox_dir = "/proc/no/such/place";
  const auto client = MappingClient::Create(options, &host_);
  EXPECT_EQ(client.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(client.status().message()), HasSubstr("outbox_dir"));
}

TEST_F(MappingClientRestartTest, TheRobotMayStartBeforeTheServer) {
  // A port that was free a moment ago.
  std::string address;
  { address = SilentSocket().address(); }
  const auto client = Connect(Options(address));
  for (int64_t i = 0; i < 3; ++i) ASSERT_TRUE(client->AddSubmap(StraightSubmap(i)).ok());
  ASSERT_TRUE(client->WaitUntilPersisted(kPatience).ok());
  ScriptedMappingServer server({[](int, Upload& upload) {
                                 upload.Ready(0);
                                 return upload.AcknowledgeEverything();
                               }},
                               address);
  EXPECT_TRUE(client->WaitUntilAcknowledged(kPatience).ok());
  EXPECT_THAT(server.Received(), ElementsAre(0, 1, 2));
}

TEST_F(MappingClientRestartTest, AServerThatLostTheMissionIsToldOnceAndNothingIsThrownAway) {
  ScriptedMappingServer server({[&](int call, Upload& upload) {
    if (call == 0) {
      upload.Ready(0);
      upload.Ack(upload.Read());
      upload.Ack(upload.Read());
      upload.Read();
      return grpc::Status(grpc::StatusCode::UNAVAILABLE, "crash");
    }
    upload.Ready(0);
    while (upload.Read() >= 0) {
    }
    return grpc::Status::OK;
  }});
  const auto client = Connect(Options(server.address()));
  for (int64_t i = 0; i < 3; ++i) ASSERT_TRUE(client->AddSubmap(StraightSubmap(i)).ok());
  ASSERT_TRUE(host_.Await([&] { return !host_.rejected.empty(); }));
  const absl::Time deadline = absl::Now() + kPatience;
  while (server.Headers().size() < 6 && absl::Now() < deadline) std::this_thread::yield();
  EXPECT_EQ(client->Stats().submaps_waiting, 1);
  EXPECT_EQ(client->WaitUntilAcknowledged(absl::ZeroDuration()).code(),
            absl::StatusCode::kDataLoss);
  absl::MutexLock lock(&host_.mutex);
  ASSERT_EQ(host_.rejected.size(), 1u);
  EXPECT_EQ(host_.rejected[0].first, 2);
  EXPECT_EQ(host_.rejected[0].second.code(), absl::StatusCode::kDataLoss);
}

TEST_F(MappingClientRestartTest, ADamagedOutboxIsToldAndTheRobotGoesOn) {
  LeaveBehind("run_1", 3);
  const std::string file = directory_.File("outbox/town.robot_a.run_1.outbox");
  std::filesystem::resize_file(file, 100);
  TownServer town;
  const auto client = Connect(Options(town.server.address()));
  EXPECT_THAT(Log(), Contains(HasSubstr("damaged-1")));
  const SubmapPosition next = client->NextSubmap();
  EXPECT_TRUE(client->AddSubmap(StraightSubmap(next.sequence)).ok());
}

// A cloud that cannot be encoded is found out after AddSubmap has returned.
TEST_F(MappingClientRestartTest, ACloudThatCannotBeEncodedCostsNoKeyframe) {
  TownServer town;
  const auto client = Connect(Options(town.server.address()));
  Submap submap = WithClouds(StraightSubmap(0), 2);
  PointCloud broken = *submap.clouds[0].cloud;
  broken.points[3].x() = std::numeric_limits<float>::quiet_NaN();
  submap.clouds[0].cloud = std::make_shared<const PointCloud>(broken);
  ASSERT_TRUE(client->AddSubmap(submap).ok());
  ASSERT_TRUE(client->WaitUntilAcknowledged(kPatience).ok());
  EXPECT_THAT(town.mission("run_1").stored, ElementsAre(0));
  EXPECT_EQ(town.server.Blobs().size(), 1u);
  EXPECT_TRUE(host_.Await([&] { return !host_.clouds_dropped.empty(); }));
  EXPECT_EQ(client->Stats().clouds_dropped, 1);
}

TEST_F(MappingClientRestartTest, DroppedCloudsAreCountedOverRestarts) {
  {
    MappingClientOptions options = Options(kNowhere);
    options.outbox_capacity_bytes = 1 << 20;
    const auto client = Connect(options);
    for (int64_t i = 0; i < 40; ++i) {
      ASSERT_TRUE(client->AddSubmap(WithClouds(StraightSubmap(i), 4, 10'000)).ok());
    }
  }
  const auto client = Connect(Options(kNowhere));
  const int64_t dropped = client->Stats().clouds_dropped;
  EXPECT_GT(dropped, 50);
  EXPECT_EQ(client->Stats().submaps_waiting, 40);
  EXPECT_EQ(client->Stats().blobs_waiting, 160 - dropped);
  EXPECT_TRUE(client->AddSubmap(StraightSubmap(40)).ok());
  EXPECT_TRUE(host_.Await([&] { return !host_.clouds_dropped.empty(); }));
}

TEST_F(MappingClientRestartTest, MeasuresTheServersClock) {
  ScriptedMappingServer* running = nullptr;
  ScriptedMappingServer server({{},
                                [&](int, ScriptedMappingServer::Watch& watch) {
                                  for (int i = 0; i < 3; ++i) watch.Heartbeat();
                                  return running->Park();
                                },
                                {},
                                [](v1::GetServerInfoResponse& response) {
                                  const absl::Time time = absl::Now() - absl::Seconds(3600);
                                  response.mutable_server_time()->set_seconds(
                                      absl::ToUnixSeconds(time));
                                }});
  running = &server;
  const auto client = Connect(Options(server.address()));
  const absl::Time deadline = absl::Now() + kPatience;
  while (std::isnan(client->Stats().clock_offset_s) && absl::Now() < deadline) {
    std::this_thread::yield();
  }
  const MappingClientStats stats = client->Stats();
  // The server's whole seconds cost up to one.
  EXPECT_NEAR(stats.clock_offset_s, 3600, 1.01 + stats.clock_offset_uncertainty_s);
  EXPECT_GT(stats.clock_offset_uncertainty_s, 0);
  EXPECT_THAT(Log(), Contains(HasSubstr("ahead of the server's")));
}

}  // namespace
}  // namespace overtone
