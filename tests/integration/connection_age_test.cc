// SPDX-License-Identifier: Apache-2.0
// A real client on connections that a server in a process of its own ends again and again.
#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <string>

#include "absl/time/clock.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/client/cli/admin_client.h"
#include "overtone/client/cli/server_process.h"
#include "overtone/client/mapping_client.h"
#include "overtone/tests/support/fake_host.h"
#include "overtone/tests/support/straight_mission.h"

namespace overtone {
namespace {

using ::testing::Contains;
using ::testing::Not;

constexpr absl::Duration kPatience = absl::Seconds(60);

TEST(ConnectionAge, AClientGoesOnUnnoticedThroughSixConnections) {
  const std::string base = ::testing::TempDir() + "connection_age_" + std::to_string(getpid());
  std::ofstream(base + ".yaml") << "limits: {max_connection_age_s: 1}\n"
                                   "publisher: {heartbeat_s: 0.2}\n"
                                   "graph: {min_distance_m: 0, min_rotation_rad: 0}\n";
  auto server = ServerProcess::Start(OVERTONE_SERVER, {"--config", base + ".yaml"}, base + ".log",
                                     [] { return absl::OkStatus(); });
  ASSERT_TRUE(server.ok()) << server.status();

  FakeHost host;
  MappingClientOptions options;
  options.server = (*server)->address();
  options.map = "town";
  options.mission = TestMission();
  options.min_time_between_comparisons = absl::InfiniteDuration();
  auto client = MappingClient::Create(options, &host);
  ASSERT_TRUE(client.ok()) << client.status();

  int64_t submaps = 0;
  const absl::Time deadline = absl::Now() + kPatience;
  while ((*client)->Stats().reconnects < 5 && absl::Now() < deadline) {
    ASSERT_TRUE((*client)->AddSubmap(StraightSubmap(submaps++, 1)).ok());
    ASSERT_TRUE((*client)->WaitUntilAcknowledged(kPatience).ok());
  }
  const MappingClientStats stats = (*client)->Stats();
  std::printf("%ld submaps, %ld reconnects\n", static_cast<long>(submaps),
              static_cast<long>(stats.reconnects));
  EXPECT_GE(stats.reconnects, 5);
  EXPECT_EQ(stats.submaps_acknowledged, submaps);
  AdminClient admin((*server)->address(), kPatience);
  auto map = admin.GetMap("town");
  while (map.ok() && map->front_end_backlog() > 0 && absl::Now() < deadline) {
    map = admin.GetMap("town");
  }
  ASSERT_TRUE(map.ok()) << map.status();
  EXPECT_EQ(map->keyframes(), submaps);
  absl::MutexLock lock(&host.mutex);
  EXPECT_THAT(host.link_states, Not(Contains(LinkState::kStale)));
  EXPECT_TRUE(host.rejected.empty());
}

}  // namespace
}  // namespace overtone
