// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/background_thread.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <thread>

#include "gtest/gtest.h"

namespace overtone {
namespace {

int Niceness() { return getpriority(PRIO_PROCESS, static_cast<id_t>(gettid())); }

TEST(BackgroundThread, GoesBehindTheOthersWithTheThreadsItStarts) {
  const int before = Niceness();
  int behind = 0, child = 0;
  std::thread([&] {
    RunInBackground();
    behind = Niceness();
    std::thread([&] { child = Niceness(); }).join();
  }).join();
  EXPECT_EQ(behind, std::min(before + 5, 19));
  EXPECT_EQ(child, behind);
  EXPECT_EQ(Niceness(), before);
}

}  // namespace
}  // namespace overtone
