// SPDX-License-Identifier: Apache-2.0
// How long a server that was killed takes to serve again, by what it has stored: 1,000 submaps of
// ten keyframes and a cloud each. OVERTONE_TEST_RESTART_SUBMAPS: another number.
#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/time/clock.h"
#include "grpcpp/create_channel.h"
#include "grpcpp/security/credentials.h"
#include "gtest/gtest.h"
#include "overtone/client/mapping_client.h"
#include "overtone/tests/fault/map_audit.h"
#include "overtone/tests/fault/server_under_fault.h"
#include "overtone/tests/support/fake_host.h"
#include "overtone/tests/support/fault_table.h"
#include "overtone/tests/support/straight_mission.h"
#include "overtone/tests/support/temporary_directory.h"

namespace overtone {
namespace {

constexpr char kMap[] = "town";
constexpr int kRobots = 4, kKeyframes = 10, kRestarts = 5;
// Of time that nobody should have to wait, on a machine that does other work, too.
constexpr absl::Duration kLongest = absl::Seconds(60);

// Hands over `submaps` of one robot and waits until the server has them.
void Upload(const std::string& address, const MissionId& mission, int64_t submaps) {
  FakeHost host;
  MappingClientOptions options;
  options.server = address;
  options.map = kMap;
  options.mission = mission;
  options.min_time_between_comparisons = absl::InfiniteDuration();
  const auto client = MappingClient::Create(options, &host);
  ASSERT_TRUE(client.ok()) << client.status();
  for (int64_t i = 0; i < submaps; ++i) {
    const Submap submap = WithClouds(StraightSubmap(i, kKeyframes), 1, 200);
    ASSERT_TRUE((*client)->AddSubmap(submap).ok());
  }
  const absl::Status status = (*client)->WaitUntilAcknowledged(absl::Minutes(20));
  ASSERT_TRUE(status.ok()) << status;
}

uint64_t RevisionOf(const std::string& address) {
  const auto stub =
      v1::MappingService::NewStub(grpc::CreateChannel(address, grpc::InsecureChannelCredentials()));
  v1::GetGraphRequest request;
  request.set_map(kMap);
  grpc::ClientContext context;
  context.set_deadline(absl::ToChronoTime(absl::Now() + kLongest));
  v1::GetGraphResponse response;
  const grpc::Status status = stub->GetGraph(&context, request, &response);
  EXPECT_TRUE(status.ok()) << status.error_message();
  return response.graph().revision();
}

std::string Figures(std::vector<double> times_ms) {
  std::sort(times_ms.begin(), times_ms.end());
  return absl::StrFormat("%.0f ms, %.0f ms", times_ms[times_ms.size() / 2], times_ms.back());
}

TEST(RestartTime, IsShort) {
  const int64_t submaps = FromEnvironment("OVERTONE_TEST_RESTART_SUBMAPS", 1000);
  const TemporaryDirectory directory;
  ServerUnderFault server(directory.path());
  ASSERT_TRUE(server.Start().ok());
  for (int i = 0; i < kRobots; ++i) {
    Upload(server.address(), {absl::StrCat("robot_", i), "run_1"}, submaps / kRobots);
  }
  const absl::Status mapped = AwaitMapped(
      server.address(), kMap, submaps / kRobots * kRobots * kKeyframes, absl::Minutes(20));
  ASSERT_TRUE(mapped.ok()) << mapped;
  const uint64_t revision = RevisionOf(server.address());
  std::vector<double> serving_ms, graph_ms;
  for (int i = 0; i < kRestarts; ++i) {
    server.Kill();
    const absl::Time begin = absl::Now();
    ASSERT_TRUE(server.Start().ok());
    serving_ms.push_back(absl::ToDoubleMilliseconds(absl::Now() - begin));
    EXPECT_GE(RevisionOf(server.address()), revision);
    graph_ms.push_back(absl::ToDoubleMilliseconds(absl::Now() - begin));
  }
  FaultRow("restart",
           absl::StrCat(submaps, " stored submaps, ", submaps * kKeyframes,
                        " keyframes: serving, p50 and max"),
           Figures(serving_ms));
  FaultRow("restart", absl::StrCat(submaps, " stored submaps: first graph, p50 and max"),
           Figures(graph_ms));
  EXPECT_LT(*std::max_element(graph_ms.begin(), graph_ms.end()),
            absl::ToDoubleMilliseconds(kLongest));
}

}  // namespace
}  // namespace overtone
