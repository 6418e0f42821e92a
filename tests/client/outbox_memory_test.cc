// SPDX-License-Identifier: Apache-2.0
// What waits on disk costs no memory: more of it than the client may take.
#include <fstream>
#include <iostream>
#include <string>

#include "gtest/gtest.h"
#include "overtone/client/mapping_client.h"
#include "overtone/tests/support/fake_host.h"
#include "overtone/tests/support/straight_mission.h"
#include "overtone/tests/support/temporary_directory.h"

namespace overtone {
namespace {

constexpr double kLimitMb = 40;

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kSanitized = true;  // shadow memory is not what we measure
#else
constexpr bool kSanitized = false;
#endif

double ResidentMb() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind("VmRSS:", 0) == 0) return std::stod(line.substr(6)) / 1024;
  }
  return -1;
}

TEST(OutboxMemory, StaysBelowFortyMegabytesWithMoreWaitingOnDisk) {
  const TemporaryDirectory directory;
  FakeHost host;
  MappingClientOptions options;
  options.server = "127.0.0.1:1";
  options.mission = TestMission();
  options.outbox_dir = directory.path();
  const auto client = MappingClient::Create(options, &host);
  ASSERT_TRUE(client.ok()) << client.status();
  for (int64_t i = 0; (*client)->Stats().bytes_waiting < 60'000'000; ++i) {
    ASSERT_TRUE((*client)->AddSubmap(WithClouds(StraightSubmap(i), 1, 20'000)).ok());
    ASSERT_TRUE((*client)->WaitUntilPersisted(absl::Seconds(60)).ok());
  }
  const MappingClientStats stats = (*client)->Stats();
  EXPECT_EQ(stats.clouds_dropped, 0);
  EXPECT_TRUE(stats.outbox_on_disk);
  std::cout << "resident: " << ResidentMb() << " MB with "
            << static_cast<double>(stats.bytes_waiting) / 1e6 << " MB waiting\n";
  if (!kSanitized) {
    EXPECT_LT(ResidentMb(), kLimitMb);
  }
}

}  // namespace
}  // namespace overtone
