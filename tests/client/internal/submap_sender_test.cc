// SPDX-License-Identifier: Apache-2.0
// What the sender makes of answers that no server of ours gives; the rest is tested through the
// uploader.
#include "overtone/client/internal/submap_sender.h"

#include <limits>
#include <memory>
#include <string>

#include "gtest/gtest.h"

namespace overtone {
namespace {

v1::UploadReady Ready(int64_t next_sequence) {
  v1::UploadReady ready;
  ready.set_next_sequence(next_sequence);
  ready.set_window_bytes(1 << 20);
  return ready;
}

TEST(SubmapSender, ARejectedReadyLeavesTheOutboxAsItIs) {
  SubmapOutbox outbox(1 << 20);
  const auto bytes = std::make_shared<const std::string>("submap");
  ASSERT_TRUE(outbox.PushSubmap({0, 0, bytes}, {}).ok());
  for (const int64_t sequence : {int64_t{-1}, std::numeric_limits<int64_t>::min()}) {
    SubmapSender sender(&outbox);
    EXPECT_TRUE(absl::IsInternal(sender.OnReady(Ready(sequence)))) << sequence;
    EXPECT_FALSE(sender.Next(0)->has_value()) << "not ready, nothing goes out";
  }
  EXPECT_EQ(outbox.Level().submaps, 1);
}

TEST(SubmapSender, AServerFarAheadOfTheHostIsBelieved) {
  SubmapOutbox outbox(1 << 20);
  SubmapSender sender(&outbox);
  constexpr int64_t kFar = std::numeric_limits<int64_t>::max();
  ASSERT_TRUE(sender.OnReady(Ready(kFar)).ok());
  EXPECT_EQ(sender.acknowledged_through(), kFar - 1);
  EXPECT_FALSE(sender.Next(0)->has_value());
}

}  // namespace
}  // namespace overtone
