// SPDX-License-Identifier: Apache-2.0
// What the client costs the robot: resident memory with a graph of 10,000 nodes. The client runs in
// a process of its own, forked before gRPC starts, so that the server's memory does not count.
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <iostream>
#include <string>

#include "gtest/gtest.h"
#include "overtone/client/mapping_client.h"
#include "overtone/proto/conversion/graph_conversion.h"
#include "overtone/tests/support/fake_host.h"
#include "overtone/tests/support/scripted_mapping_server.h"
#include "overtone/tests/support/straight_mission.h"

namespace overtone {
namespace {

constexpr int kNumNodes = 10'000;
constexpr double kLimitMb = 40;

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kSanitized = true;  // shadow memory is not what we measure
#else
constexpr bool kSanitized = false;
#endif

// A line of /proc/self/status, in megabytes.
double StatusMb(const std::string& key) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind(key + ":", 0) == 0) return std::stod(line.substr(key.size() + 1)) / 1024;
  }
  return -1;
}

struct Measured {
  bool ok = false;
  double before_mb = 0, connected_mb = 0, with_graph_mb = 0, peak_mb = 0;
};

Measured RunRobot(const std::string& address) {
  Measured measured;
  measured.before_mb = StatusMb("VmRSS");
  FakeHost host;
  host.trajectory = BentTrajectory(kNumNodes, /*bend_m=*/20);
  MappingClientOptions options;
  options.server = address;
  options.mission = TestMission();
  options.min_time_between_comparisons = absl::InfiniteDuration();
  const auto client = MappingClient::Create(options, &host);
  if (!client.ok()) return measured;
  measured.connected_mb = StatusMb("VmRSS");
  if (!(*client)->WaitForKeyframe(kNumNodes - 1, 1, absl::Seconds(30)).ok()) return measured;
  measured.with_graph_mb = StatusMb("VmRSS");
  measured.ok = (*client)->Synchronize().ok();
  measured.peak_mb = StatusMb("VmHWM");
  return measured;
}

TEST(MappingClientMemory, StaysBelowFortyMegabytesWithTenThousandNodes) {
  int to_robot[2];
  int from_robot[2];
  ASSERT_EQ(pipe(to_robot), 0);
  ASSERT_EQ(pipe(from_robot), 0);
  const pid_t robot = fork();
  ASSERT_GE(robot, 0);
  if (robot == 0) {
    char address[64] = {};
    Measured measured;
    if (read(to_robot[0], address, sizeof(address) - 1) > 0) measured = RunRobot(address);
    _exit(write(from_robot[1], &measured, sizeof(measured)) == sizeof(measured) ? 0 : 1);
  }

  ScriptedMappingServer* parking = nullptr;
  ScriptedMappingServer server({{},
                                [&](int, ScriptedMappingServer::Watch& watch) {
                                  GraphFormat format;
                                  format.map = "default";
                                  watch.Snapshot(ToProto(StraightGraph(kNumNodes, 1), format));
                                  return parking->Park();
                                },
                                {}});
  parking = &server;
  const std::string address = server.address();
  ASSERT_EQ(write(to_robot[1], address.data(), address.size()), address.size());
  Measured measured;
  ASSERT_EQ(read(from_robot[0], &measured, sizeof(measured)), sizeof(measured));
  int status = -1;
  waitpid(robot, &status, 0);
  EXPECT_EQ(status, 0);
  ASSERT_TRUE(measured.ok);
  std::cout << "resident: " << measured.before_mb << " MB before the client, "
            << measured.connected_mb << " MB with it, " << measured.with_graph_mb << " MB with "
            << kNumNodes << " nodes, " << measured.peak_mb << " MB at the peak of a comparison\n";
  if (kSanitized) return;
  EXPECT_LT(measured.with_graph_mb, kLimitMb);
  EXPECT_LT(measured.peak_mb, kLimitMb);
}

}  // namespace
}  // namespace overtone
