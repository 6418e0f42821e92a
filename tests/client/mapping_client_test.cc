// SPDX-License-Identifier: Apache-2.0
// The whole client against a scripted server.
#include "overtone/client/mapping_client.h"

#include <algorithm>
#include <iostream>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "absl/synchronization/notification.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/proto/conversion/graph_conversion.h"
#include "overtone/tests/support/fake_host.h"
#include "overtone/tests/support/scripted_mapping_server.h"
#include "overtone/tests/support/straight_mission.h"

namespace overtone {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using Upload = ScriptedMappingServer::Upload;
using Watch = ScriptedMappingServer::Watch;

constexpr absl::Duration kPatience = absl::Seconds(20);

MappingClientOptions OptionsFor(const std::string& address) {
  MappingClientOptions options;
  options.server = address;
  options.map = "town";
  options.mission = TestMission();
  options.initial_backoff = absl::Milliseconds(2);
  options.max_backoff = absl::Milliseconds(50);
  options.min_time_between_comparisons = absl::InfiniteDuration();
  return options;
}

std::unique_ptr<MappingClient> Connect(MappingClientOptions options, HostEstimator* host) {
  auto client = MappingClient::Create(std::move(options), host);
  EXPECT_TRUE(client.ok()) << client.status();
  return *std::move(client);
}

v1::Graph Message(int num_nodes, uint64_t revision) {
  GraphFormat format;
  format.map = "town";
  return ToProto(StraightGraph(num_nodes, revision), format);
}

// Acknowledges every submap, and shows a straight map of 60 nodes.
struct StraightTown {
  ScriptedMappingServer server{{[](int, Upload& upload) {
                                  upload.Ready(0);
                                  return upload.AcknowledgeEverything();
                                },
                                [this](int, Watch& watch) {
                                  watch.Snapshot(Message(60, 4));
                                  return server.Park();
                                },
                                {}}};
};

TEST(MappingClient, CreateNamesTheBadOptionAndRefusesANullHost) {
  FakeHost host;
  MappingClientOptions options = OptionsFor("127.0.0.1:1");
  EXPECT_EQ(MappingClient::Create(options, nullptr).status().code(),
            absl::StatusCode::kInvalidArgument);
  options.map = "No Such Name";
  EXPECT_THAT(std::string(MappingClient::Create(options, &host).status().message()),
              HasSubstr("map"));
}

TEST(MappingClient, SubmapsGoUpTheMapComesDownAndTheHostIsCorrected) {
  StraightTown town;
  FakeHost host;
  host.trajectory = BentTrajectory(60, /*bend_m=*/0.5);
  const auto client = Connect(OptionsFor(town.server.address()), &host);
  for (int64_t i = 0; i < 6; ++i) ASSERT_TRUE(client->AddSubmap(StraightSubmap(i)).ok());
  ASSERT_TRUE(client->WaitUntilAcknowledged(kPatience).ok());
  ASSERT_TRUE(client->WaitForKeyframe(59, 4, kPatience).ok());
  EXPECT_EQ(client->WaitForKeyframe(60, 4, absl::Milliseconds(1)).code(),
            absl::StatusCode::kDeadlineExceeded);
  EXPECT_EQ(client->WaitForKeyframe(59, 5, absl::Milliseconds(1)).code(),
            absl::StatusCode::kDeadlineExceeded);

  const auto report = client->Synchronize();
  ASSERT_TRUE(report.ok()) << report.status();
  EXPECT_FALSE(report->batch.empty());
  EXPECT_TRUE(report->host_status.ok());
  EXPECT_EQ(client->Graph()->NumNodes(), 60);

  const MappingClientStats stats = client->Stats();
  EXPECT_EQ(stats.link_state, LinkState::kLive);
  EXPECT_EQ(stats.submaps_acknowledged, 6);
  EXPECT_EQ(stats.submaps_waiting, 0);
  EXPECT_EQ(stats.bytes_waiting, 0);
  EXPECT_EQ(stats.revision, 4);
  EXPECT_EQ(stats.comparisons, 1);
  EXPECT_GT(stats.bytes_sent, 6 * 10 * 21 * 8);  // a covariance for each keyframe at the least
  EXPECT_GT(stats.bytes_received, 60 * 10);
}

TEST(MappingClient, CorrectsByItselfWhenARevisionComes) {
  StraightTown town;
  FakeHost host;
  host.trajectory = BentTrajectory(60, /*bend_m=*/0.5);
  MappingClientOptions options = OptionsFor(town.server.address());
  options.min_time_between_comparisons = absl::ZeroDuration();
  const auto client = Connect(options, &host);
  EXPECT_TRUE(host.Await([&] { return !host.batches.empty(); }));
}

TEST(MappingClient, AsksForTheGraphItsOptionsDescribe) {
  StraightTown town;
  FakeHost host;
  MappingClientOptions options = OptionsFor(town.server.address());
  options.max_nodes = 500;
  const auto own = Connect(options, &host);
  ASSERT_TRUE(town.server.AwaitWatches(1));
  options.whole_map = true;
  options.compact = false;
  const auto whole = Connect(options, &host);
  ASSERT_TRUE(town.server.AwaitWatches(2));
  const std::vector<v1::WatchGraphRequest> watches = town.server.Watches();
  EXPECT_EQ(watches[0].map(), "town");
  EXPECT_EQ(watches[0].options().max_nodes(), 500);
  EXPECT_EQ(watches[0].options().encoding(), v1::GRAPH_ENCODING_COMPACT);
  EXPECT_EQ(watches[0].options().robot(), TestMission().robot);
  EXPECT_EQ(watches[1].options().encoding(), v1::GRAPH_ENCODING_PLAIN);
  EXPECT_EQ(watches[1].options().robot(), "");
}

TEST(MappingClient, NamesWhatIsWrongWithASubmapAndGoesOnWithAGoodOne) {
  FakeHost host;
  const auto client = Connect(OptionsFor("127.0.0.1:1"), &host);
  const double nan = std::numeric_limits<double>::quiet_NaN();

  EXPECT_EQ(client->AddSubmap(StraightSubmap(1)).code(), absl::StatusCode::kOutOfRange);
  const auto expect_invalid = [&](const Submap& submap, const std::string& field) {
    const absl::Status status = client->AddSubmap(submap);
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << field;
    EXPECT_THAT(std::string(status.message()), HasSubstr(field));
  };
  Submap empty = StraightSubmap(0);
  empty.keyframes.clear();
  expect_invalid(empty, "keyframes");
  Submap not_finite = StraightSubmap(0);
  not_finite.keyframes[3].mission_from_body.translation.y() = nan;
  expect_invalid(not_finite, "keyframes[3].mission_tform_body");
  Submap not_positive_definite = StraightSubmap(0);
  not_positive_definite.keyframes[4].motion_covariance(2, 2) = -1;
  expect_invalid(not_positive_definite, "keyframes[4].motion_covariance");
  Submap back_in_time = StraightSubmap(0);
  back_in_time.keyframes[5].stamp = back_in_time.keyframes[4].stamp;
  expect_invalid(back_in_time, "keyframes[5].stamp");

  EXPECT_TRUE(client->AddSubmap(StraightSubmap(0)).ok());
  EXPECT_EQ(client->AddSubmap(StraightSubmap(0)).code(), absl::StatusCode::kOutOfRange);
  EXPECT_TRUE(client->AddSubmap(StraightSubmap(1)).ok());
  EXPECT_EQ(client->Stats().submaps_waiting, 2);
}

TEST(MappingClient, NamesWhatIsWrongWithALoopClosure) {
  FakeHost host;
  const auto client = Connect(OptionsFor("127.0.0.1:1"), &host);
  std::vector<LoopClosure> closures = {ClosureBetween(0, 5), ClosureBetween(1, 6)};
  EXPECT_TRUE(client->AddLoopClosures(closures).ok());
  EXPECT_TRUE(client->AddLoopClosures({}).ok());
  closures[1].covariance.setZero();
  const absl::Status status = client->AddLoopClosures(closures);
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(status.message()), HasSubstr("loop_closures[1].covariance"));
  EXPECT_EQ(client->AddLoopClosures(std::vector<LoopClosure>(2001, ClosureBetween(0, 5))).code(),
            absl::StatusCode::kInvalidArgument);
}

TEST(MappingClient, AFullOutboxSaysSoAndTakesTheSameSubmapOnceThereIsRoom) {
  absl::Notification open;
  ScriptedMappingServer server({[&](int, Upload& upload) {
    open.WaitForNotification();
    upload.Ready(0);
    return upload.AcknowledgeEverything();
  }});
  FakeHost host;
  MappingClientOptions options = OptionsFor(server.address());
  options.outbox_capacity_bytes = 1 << 20;
  const auto client = Connect(options, &host);
  int64_t sequence = 0;
  absl::Status status;
  while (status.ok() && sequence < 1000) {
    status = client->AddSubmap(StraightSubmap(sequence, 100));
    if (status.ok()) ++sequence;
  }
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_GT(sequence, 10);
  EXPECT_LE(client->Stats().bytes_waiting, 1 << 20);
  EXPECT_EQ(client->WaitUntilAcknowledged(absl::Milliseconds(1)).code(),
            absl::StatusCode::kDeadlineExceeded);

  open.Notify();
  ASSERT_TRUE(client->WaitUntilAcknowledged(kPatience).ok());
  EXPECT_TRUE(client->AddSubmap(StraightSubmap(sequence, 100)).ok());
}

TEST(MappingClient, CloudsGoUpBehindTheirSubmaps) {
  StraightTown town;
  FakeHost host;
  const auto client = Connect(OptionsFor(town.server.address()), &host);
  for (int64_t i = 0; i < 3; ++i) {
    const absl::Status status = client->AddSubmap(WithClouds(StraightSubmap(i), 4));
    ASSERT_TRUE(status.ok()) << status;
  }
  ASSERT_TRUE(client->WaitUntilAcknowledged(kPatience).ok());
  const std::vector<std::string> blobs = town.server.Blobs();
  ASSERT_EQ(blobs.size(), 12u);
  for (const std::string& blob : blobs) EXPECT_EQ(DecodePointCloud(blob)->size(), 50u);
  EXPECT_EQ(client->Stats().submaps_acknowledged, 3);
  EXPECT_EQ(client->Stats().blobs_waiting, 0);
  EXPECT_EQ(client->Stats().clouds_dropped, 0);
}

TEST(MappingClient, NamesWhatIsWrongWithACloudAndWaitsForThoseThatAreRight) {
  FakeHost host;
  const auto client = Connect(OptionsFor("127.0.0.1:1"), &host);
  Submap submap = WithClouds(StraightSubmap(0), 2);
  submap.clouds[1].index = 10;
  EXPECT_THAT(std::string(client->AddSubmap(submap).message()), HasSubstr("clouds[1].index: 10"));
  submap.clouds[1].index = 0;
  EXPECT_THAT(std::string(client->AddSubmap(submap).message()), HasSubstr("clouds[1].index"));
  submap.clouds[1] = {1, nullptr};
  EXPECT_THAT(std::string(client->AddSubmap(submap).message()), HasSubstr("clouds[1].cloud"));
  submap.clouds.pop_back();
  EXPECT_TRUE(client->AddSubmap(submap).ok());
  ASSERT_TRUE(client->WaitUntilPersisted(kPatience).ok());
  EXPECT_EQ(client->Stats().blobs_waiting, 1);
  EXPECT_THAT(std::string(client->WaitUntilAcknowledged(absl::ZeroDuration()).message()),
              HasSubstr("1 clouds"));
}

// 1.6 MB of clouds and as much of keyframes through an outbox of 2 MiB: the oldest clouds go, no
// keyframe does.
TEST(MappingClient, AFullOutboxDropsTheOldestCloudsAndTellsTheHost) {
  FakeHost host;
  MappingClientOptions options = OptionsFor("127.0.0.1:1");
  options.outbox_capacity_bytes = 2 << 20;
  const auto client = Connect(options, &host);
  for (int64_t i = 0; i < 40; ++i) {
    ASSERT_TRUE(client->AddSubmap(WithClouds(StraightSubmap(i, 150), 1, 10'000)).ok());
  }
  ASSERT_TRUE(client->WaitUntilPersisted(kPatience).ok());
  const MappingClientStats stats = client->Stats();
  EXPECT_EQ(stats.submaps_waiting, 40);
  EXPECT_GT(stats.clouds_dropped, 5);
  EXPECT_EQ(stats.blobs_waiting + stats.clouds_dropped, 40);
  EXPECT_LE(stats.bytes_waiting, 2 << 20);
  EXPECT_TRUE(host.Await([&] {
    return !host.clouds_dropped.empty() && host.clouds_dropped.back() == stats.clouds_dropped;
  }));
  absl::MutexLock lock(&host.mutex);
  EXPECT_TRUE(std::is_sorted(host.clouds_dropped.begin(), host.clouds_dropped.end()));
}

TEST(MappingClient, ARefusedSubmapIsToldOnceWithThoseThatFollowAndCanBeHandedOverAnew) {
  absl::Notification three_added;
  ScriptedMappingServer server({[&](int call, Upload& upload) {
    three_added.WaitForNotification();
    upload.Ready(call == 0 ? 0 : 1);
    if (call > 0) return upload.AcknowledgeEverything();
    upload.Read();
    upload.Ack(0);
    upload.Reject(upload.Read(), grpc::StatusCode::PERMISSION_DENIED, "mission: not yours");
    while (upload.Read() >= 0) {
    }
    return grpc::Status::OK;
  }});
  FakeHost host;
  const auto client = Connect(OptionsFor(server.address()), &host);
  for (int64_t i = 0; i < 3; ++i) ASSERT_TRUE(client->AddSubmap(StraightSubmap(i)).ok());
  three_added.Notify();
  EXPECT_EQ(client->WaitUntilAcknowledged(kPatience).code(), absl::StatusCode::kPermissionDenied);
  ASSERT_TRUE(host.Await([&] { return host.rejected.size() >= 2; }));

  EXPECT_EQ(client->AddSubmap(StraightSubmap(3)).code(), absl::StatusCode::kOutOfRange);
  for (int64_t i = 1; i < 4; ++i) ASSERT_TRUE(client->AddSubmap(StraightSubmap(i)).ok());
  EXPECT_TRUE(client->WaitUntilAcknowledged(kPatience).ok());
  EXPECT_EQ(client->Stats().submaps_acknowledged, 4);

  absl::MutexLock lock(&host.mutex);
  ASSERT_EQ(host.rejected.size(), 2);
  EXPECT_EQ(host.rejected[0].first, 1);
  EXPECT_EQ(host.rejected[0].second.code(), absl::StatusCode::kPermissionDenied);
  EXPECT_EQ(host.rejected[1].first, 2);
  EXPECT_EQ(host.rejected[1].second.code(), absl::StatusCode::kFailedPrecondition);
}

TEST(MappingClient, RefusedLoopClosuresReachTheHost) {
  ScriptedMappingServer server({{}, {}, [](int, const v1::AddLoopClosuresRequest& request) {
                                  EXPECT_EQ(request.map(), "town");
                                  EXPECT_EQ(request.loop_closures_size(), 1);
                                  return grpc::Status(grpc::StatusCode::INVALID_ARGUMENT, "no");
                                }});
  FakeHost host;
  const auto client = Connect(OptionsFor(server.address()), &host);
  ASSERT_TRUE(client->AddLoopClosures({ClosureBetween(0, 5)}).ok());
  EXPECT_EQ(client->WaitUntilAcknowledged(kPatience).code(), absl::StatusCode::kInvalidArgument);
  EXPECT_TRUE(host.Await([&] { return host.rejected_closures.size() == 1; }));
}

TEST(MappingClient, SynchronizeSaysWhatIsMissing) {
  FakeHost host;
  const auto away = Connect(OptionsFor("127.0.0.1:1"), &host);
  EXPECT_EQ(away->Synchronize().status().code(), absl::StatusCode::kFailedPrecondition);

  StraightTown town;
  const auto client = Connect(OptionsFor(town.server.address()), &host);
  ASSERT_TRUE(client->WaitForKeyframe(0, 1, kPatience).ok());
  EXPECT_EQ(client->Synchronize().status().code(),
            absl::StatusCode::kFailedPrecondition);  // no trajectory
}

// It would wait for itself.
TEST(MappingClient, SynchronizeFromWithinTheHostIsRefused) {
  StraightTown town;
  FakeHost host;
  host.trajectory = BentTrajectory(60, /*bend_m=*/0.5);
  const auto client = Connect(OptionsFor(town.server.address()), &host);
  absl::Status inner;
  {
    absl::MutexLock lock(&host.mutex);
    host.on_apply = [&] { inner = client->Synchronize().status(); };
  }
  ASSERT_TRUE(client->WaitForKeyframe(0, 1, kPatience).ok());
  ASSERT_TRUE(client->Synchronize().ok());
  EXPECT_EQ(inner.code(), absl::StatusCode::kFailedPrecondition);
}

TEST(MappingClient, SurvivesAHostAndALogThatThrow) {
  StraightTown town;
  FakeHost host;
  host.throws = true;
  MappingClientOptions options = OptionsFor(town.server.address());
  options.log = [](LogLevel, absl::string_view) { throw std::runtime_error("disk full"); };
  const auto client = Connect(options, &host);
  ASSERT_TRUE(client->WaitForKeyframe(0, 1, kPatience).ok());
  ASSERT_TRUE(host.Await([&] { return !host.link_states.empty(); }));
  EXPECT_EQ(client->Synchronize().status().code(), absl::StatusCode::kInternal);
  {
    absl::MutexLock lock(&host.mutex);
    host.throws = false;
    host.trajectory = BentTrajectory(60, 0.5);
  }
  EXPECT_TRUE(client->Synchronize().ok());
}

TEST(MappingClient, StopsWithinASecondWhateverTheServerDoes) {
  SilentSocket half_open;
  ScriptedMappingServer parked({});
  StraightTown town;
  for (const std::string& address :
       {half_open.address(), parked.address(), town.server.address(), std::string("127.0.0.1:1"),
        std::string("no-such-host.invalid:7077"), std::string("192.0.2.1:7077")}) {
    FakeHost host;
    MappingClientOptions options = OptionsFor(address);
    options.tls.insecure = true;
    auto client = Connect(std::move(options), &host);
    ASSERT_TRUE(client->AddSubmap(StraightSubmap(0)).ok());
    ASSERT_TRUE(client->AddLoopClosures({ClosureBetween(0, 5)}).ok());
    const absl::Time start = absl::Now();
    client.reset();
    EXPECT_LT(absl::Now() - start, absl::Seconds(1)) << address;
  }
}

TEST(MappingClient, PrintsHowLongAddSubmapTakesWithTheServerAway) {
  SilentSocket half_open;
  FakeHost host;
  const auto client = Connect(OptionsFor(half_open.address()), &host);
  std::vector<double> microseconds;
  for (int64_t i = 0; i < 2000; ++i) {
    const Submap submap = StraightSubmap(i, 20);
    const absl::Time start = absl::Now();
    ASSERT_TRUE(client->AddSubmap(submap).ok());
    microseconds.push_back(absl::ToDoubleMicroseconds(absl::Now() - start));
  }
  std::sort(microseconds.begin(), microseconds.end());
  std::cout << "AddSubmap of 20 keyframes, server away: p50 " << microseconds[1000] << " us, p99 "
            << microseconds[1980] << " us, max " << microseconds.back() << " us\n";
}

TEST(MappingClient, PrintsHowLongACloudTakesTheCaller) {
  SilentSocket half_open;
  FakeHost host;
  const auto client = Connect(OptionsFor(half_open.address()), &host);
  std::vector<double> milliseconds;
  for (int64_t i = 0; i < 100; ++i) {
    const Submap submap = WithClouds(StraightSubmap(i), 1, 20'000);
    const absl::Time start = absl::Now();
    ASSERT_TRUE(client->AddSubmap(submap).ok());
    milliseconds.push_back(absl::ToDoubleMilliseconds(absl::Now() - start));
  }
  std::sort(milliseconds.begin(), milliseconds.end());
  std::cout << "AddSubmap with a cloud of 20,000 points: p50 " << milliseconds[50] << " ms, p99 "
            << milliseconds[98] << " ms\n";
}

}  // namespace
}  // namespace overtone
