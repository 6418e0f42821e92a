// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/quota/robot_quotas.h"

#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gtest/gtest.h"
#include "overtone/proto/conversion/status_conversion.h"
#include "overtone/services/mapping_server/quota/stream_quota.h"

namespace overtone {
namespace {

class RobotQuotasTest : public ::testing::Test {
 protected:
  static QuotaOptions Small() {
    QuotaOptions options;
    options.max_streams = 2;
    options.max_messages_per_s = 10;
    options.messages_burst = 20;
    options.max_bytes_per_s = 1000;
    options.bytes_burst = 4000;
    options.max_calls_per_s = 5;
    options.calls_burst = 5;
    return options;
  }

  absl::Time now_ = absl::UnixEpoch();
  RobotQuotas quotas_{Small(), [this] { return now_; }};
};

TEST_F(RobotQuotasTest, TheDefaultsAreValidAndNonsenseIsNamed) {
  EXPECT_TRUE(QuotaOptions().Validate().ok());
  QuotaOptions options;
  options.max_bytes_per_s = -1;
  EXPECT_EQ(options.Validate().message().substr(0, 15), "max_bytes_per_s");
  options = QuotaOptions();
  options.calls_burst = 0;
  EXPECT_EQ(options.Validate().message().substr(0, 11), "calls_burst");
  options = QuotaOptions();
  options.max_streams = -1;
  EXPECT_EQ(options.Validate().message().substr(0, 11), "max_streams");
}

TEST_F(RobotQuotasTest, ACallTooManyIsToldWhenToComeBack) {
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(quotas_.AdmitCall("robot/anna").ok());
  const absl::Status refused = quotas_.AdmitCall("robot/anna");
  EXPECT_EQ(refused.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(QuotaSubjectOf(refused), "robot/anna/calls");
  ASSERT_EQ(RetryDelayOf(refused), absl::Milliseconds(200));
  now_ += absl::Milliseconds(200);
  EXPECT_TRUE(quotas_.AdmitCall("robot/anna").ok());
}

TEST_F(RobotQuotasTest, StreamsAreCountedUntilTheyEnd) {
  auto first = quotas_.OpenStream("robot/anna");
  auto second = quotas_.OpenStream("robot/anna");
  ASSERT_TRUE(first.ok() && second.ok());
  const absl::Status refused = quotas_.OpenStream("robot/anna").status();
  EXPECT_EQ(refused.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(QuotaSubjectOf(refused), "robot/anna/streams");
  EXPECT_TRUE(quotas_.OpenStream("robot/bert").ok());
  first->reset();
  EXPECT_TRUE(quotas_.OpenStream("robot/anna").ok());
}

TEST_F(RobotQuotasTest, OpeningStreamsOverAndOverIsRefusedLikeOtherCalls) {
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(quotas_.OpenStream("robot/anna").ok());
  const absl::Status refused = quotas_.OpenStream("robot/anna").status();
  EXPECT_EQ(QuotaSubjectOf(refused), "robot/anna/calls");
  ASSERT_EQ(RetryDelayOf(refused), absl::Milliseconds(200));
  EXPECT_TRUE(quotas_.OpenStream("robot/bert").ok());
  now_ += absl::Milliseconds(200);
  EXPECT_TRUE(quotas_.OpenStream("robot/anna").ok());
}

// The noisy one floods over two streams; the other sends what it always does.
TEST_F(RobotQuotasTest, ANoisyRobotSlowsItselfAndNotItsNeighbour) {
  StreamQuota noisy[] = {{&quotas_, "robot/noisy"}, {&quotas_, "robot/noisy"}};
  StreamQuota calm(&quotas_, "robot/calm");
  for (StreamQuota* stream : {&noisy[0], &noisy[1], &calm}) ASSERT_TRUE(stream->Open().ok());
  absl::Time noisy_reads_at[2] = {now_, now_};
  int noisy_messages = 0;
  for (int ms = 0; ms < 10'000; ++ms, now_ += absl::Milliseconds(1)) {
    for (int i = 0; i < 2; ++i) {
      if (now_ < noisy_reads_at[i]) continue;
      noisy_reads_at[i] = now_ + noisy[i].Charge(10);
      ++noisy_messages;
    }
    if (ms % 200 == 0) {
      ASSERT_EQ(calm.Charge(100), absl::ZeroDuration()) << ms;
    }
  }
  EXPECT_NEAR(noisy_messages, 20 + 10 * 10, 5);  // what a pause leaves waiting
}

TEST_F(RobotQuotasTest, BytesCountAsWellAsMessages) {
  StreamQuota stream(&quotas_, "robot/anna");
  ASSERT_TRUE(stream.Open().ok());
  EXPECT_EQ(stream.Charge(4000), absl::ZeroDuration());
  EXPECT_EQ(stream.Charge(500), absl::Milliseconds(500));
}

TEST_F(RobotQuotasTest, AStreamBecomesItsRobotsAndLeavesTheConnectionFree) {
  StreamQuota stream(&quotas_, "ipv4:10.0.0.1:1");
  ASSERT_TRUE(stream.Open().ok());
  ASSERT_TRUE(stream.SetRobot("anna").ok());
  auto a = quotas_.OpenStream("ipv4:10.0.0.1:1");
  auto b = quotas_.OpenStream("ipv4:10.0.0.1:1");
  EXPECT_TRUE(a.ok() && b.ok());
  EXPECT_TRUE(quotas_.OpenStream("robot/anna").ok());
  const auto second = quotas_.OpenStream("robot/anna");
  EXPECT_FALSE(quotas_.OpenStream("robot/anna").ok());
}

TEST_F(RobotQuotasTest, InventedNamesTakeNoMemoryForLong) {
  const auto kept = quotas_.OpenStream("robot/kept");
  for (int i = 0; i < 100'000; ++i) {
    ASSERT_TRUE(quotas_.AdmitCall(absl::StrCat("robot/", i)).ok());
    now_ += absl::Milliseconds(10);
  }
  EXPECT_LE(quotas_.size(), 128u);
  ASSERT_TRUE(quotas_.OpenStream("robot/kept").ok());
  const auto second = quotas_.OpenStream("robot/kept");
  EXPECT_FALSE(quotas_.OpenStream("robot/kept").ok()) << "the open stream was forgotten";
}

TEST_F(RobotQuotasTest, ZeroIsNoLimit) {
  QuotaOptions none;
  none.max_streams = 0;
  none.max_messages_per_s = none.max_bytes_per_s = none.max_calls_per_s = 0;
  RobotQuotas quotas(none, [this] { return now_; });
  std::vector<StreamQuota> streams(1000, StreamQuota(&quotas, "robot/anna"));
  for (StreamQuota& stream : streams) {
    ASSERT_TRUE(stream.Open().ok());
    ASSERT_EQ(stream.Charge(int64_t{1} << 40), absl::ZeroDuration());
    ASSERT_TRUE(quotas.AdmitCall("robot/anna").ok());
  }
}

}  // namespace
}  // namespace overtone
