// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/log_limit.h"

#include <algorithm>
#include <memory>
#include <sstream>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/tests/services/mapping_server/server_fixture.h"
#include "spdlog/sinks/ostream_sink.h"

namespace overtone {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

absl::Time At(double seconds) { return absl::UnixEpoch() + absl::Seconds(seconds); }

TEST(LogLimit, TheFirstFewAtOnceThenOnePerInterval) {
  LogLimit limit(/*burst=*/3, absl::Seconds(10));
  int lines = 0;
  int64_t left_out = 0;
  for (int s = 0; s < 1000; ++s) {
    const absl::optional<int64_t> admitted = limit.Admit("submap rejected", At(s));
    if (!admitted.has_value()) continue;
    ++lines;
    left_out += *admitted;
  }
  EXPECT_NEAR(lines, 3 + 99, 1);
  // All but those after the last line are accounted for.
  EXPECT_GE(lines + left_out, 1000 - 10);
  EXPECT_LE(lines + left_out, 1000);
}

TEST(LogLimit, OneCauseDoesNotSilenceAnother) {
  LogLimit limit(1, absl::Seconds(10));
  EXPECT_EQ(limit.Admit("a", At(0)), 0);
  EXPECT_EQ(limit.Admit("a", At(1)), absl::nullopt);
  EXPECT_EQ(limit.Admit("b", At(1)), 0);
  EXPECT_EQ(limit.Admit("a", At(10)), 1);
}

TEST(LogLimit, AQuietTimeGivesTheFirstFewBack) {
  LogLimit limit(2, absl::Seconds(10));
  for (int i = 0; i < 5; ++i) limit.Admit("a", At(0));
  EXPECT_EQ(limit.Admit("a", At(100)), 3);
  EXPECT_EQ(limit.Admit("a", At(100)), 0);
  EXPECT_EQ(limit.Admit("a", At(100)), absl::nullopt);
}

// The server's own log, while a peer does all it can to fill it.
class ServerLogTest : public testing::ServerTest {
 protected:
  void SetUp() override {
    before_ = spdlog::default_logger();
    auto sink = std::make_shared<spdlog::sinks::ostream_sink_mt>(log_);
    spdlog::set_default_logger(std::make_shared<spdlog::logger>("captured", std::move(sink)));
    StartServer();
  }
  void TearDown() override {
    server_.reset();
    spdlog::set_default_logger(before_);
  }
  int64_t Lines() const {
    const std::string log = log_.str();
    return std::count(log.begin(), log.end(), '\n');
  }

  std::shared_ptr<spdlog::logger> before_;
  std::ostringstream log_;
};

TEST_F(ServerLogTest, AThousandRejectionsAreAFewLines) {
  testing::Uploader uploader(*mapping_, "mine", {"anna", "run1"});
  ASSERT_TRUE(uploader.Read().has_ready());
  v1::Submap bad = ToProto(testing::MakeSubmap(0, 0, 1));
  bad.mutable_keyframes(0)->set_stamp_ns(-1);
  for (int i = 0; i < 900; ++i) ASSERT_TRUE(uploader.Send(bad).has_reject());
  for (int i = 0; i < 90; ++i) {
    v1::BlobChunk chunk;
    chunk.set_sha256(std::string(32, '\n'));
    uploader.Write(chunk);
    ASSERT_TRUE(uploader.Read().has_blob_result());
  }
  for (int i = 0; i < 60; ++i) {
    testing::Uploader again(*mapping_, "mine", {"anna", "run2"});
    ASSERT_TRUE(again.Read().has_ready());
  }
  EXPECT_THAT(log_.str(), HasSubstr("rejected"));
  EXPECT_GE(Lines(), 12);
  EXPECT_LE(Lines(), 60);  // some start-up lines, and 10 and then one in 10 s of each of 4 causes
}

}  // namespace
}  // namespace overtone
