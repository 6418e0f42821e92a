// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/internal/status_reporter.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/synchronization/notification.h"
#include "grpcpp/create_channel.h"
#include "grpcpp/security/credentials.h"
#include "gtest/gtest.h"
#include "overtone/tests/support/scripted_mapping_server.h"

namespace overtone {
namespace {

constexpr absl::Duration kPatience = absl::Seconds(20);

// A server that keeps what it is told, and one robot's reporter.
class StatusReporterTest : public ::testing::Test {
 protected:
  StatusReporterTest() {
    settings_.map = "town";
    settings_.mission = {"anna", "run1"};
    settings_.interval = absl::Hours(1);
    settings_.min_gap = absl::ZeroDuration();
  }
  void TearDown() override {
    reporter_.reset();
    server_.reset();
  }

  void Start() {
    ScriptedMappingServer::Script script;
    script.report_status = [this](int call, const v1::ReportStatusRequest& request,
                                  v1::ReportStatusResponse& response) {
      const grpc::Status status = Answer(call, response);
      absl::MutexLock lock(&mutex_);
      told_.push_back(request);
      return status;
    };
    server_ = std::make_unique<ScriptedMappingServer>(std::move(script));
    StartAgainst(server_->address());
  }

  void StartAgainst(const std::string& address) {
    stub_ = v1::MappingService::NewStub(
        grpc::CreateChannel(address, grpc::InsecureChannelCredentials()));
    bucket_ = std::make_unique<TokenBucket>(settings_.max_upload_bytes_per_s);
    reporter_ = std::make_unique<StatusReporter>(
        stub_.get(), settings_,
        [this] {
          v1::LinkReport link;
          link.set_bytes_waiting(++asked_);
          return link;
        },
        &counters_, bucket_.get(), Logger());
    reporter_->Start();
  }

  void Compare(uint64_t revision, int nodes = 1) {
    SynchronizationReport report;
    report.comparison.revision = revision;
    report.comparison.discrepancy = Eigen::MatrixXd::Constant(nodes, 3, 1.0);
    for (int i = 0; i < nodes; ++i) report.comparison.keyframe_index.push_back(i);
    reporter_->OnComparison(report);
  }

  // Of every call; as a rule they succeed.
  virtual grpc::Status Answer(int /*call*/, v1::ReportStatusResponse& /*response*/) {
    return grpc::Status::OK;
  }

  bool AwaitTold(size_t count, absl::Duration timeout = kPatience) {
    const auto told = [&] { return mutex_.AssertHeld(), told_.size() >= count; };
    absl::MutexLock lock(&mutex_);
    return mutex_.AwaitWithTimeout(absl::Condition(&told), timeout);
  }
  std::vector<v1::ReportStatusRequest> Told() {
    absl::MutexLock lock(&mutex_);
    return told_;
  }

  StatusReporter::Settings settings_;
  TrafficCounters counters_;
  std::unique_ptr<TokenBucket> bucket_;
  int64_t asked_ = 0;  // the reporter's thread's
  std::unique_ptr<ScriptedMappingServer> server_;
  std::unique_ptr<v1::MappingService::Stub> stub_;
  std::unique_ptr<StatusReporter> reporter_;
  absl::Mutex mutex_;
  std::vector<v1::ReportStatusRequest> told_ ABSL_GUARDED_BY(mutex_);
};

TEST_F(StatusReporterTest, AComparisonIsToldWithTheLink) {
  Start();
  Compare(7);
  ASSERT_TRUE(AwaitTold(1));
  const v1::ReportStatusRequest told = Told()[0];
  EXPECT_EQ(told.map(), "town");
  EXPECT_EQ(told.mission().robot(), "anna");
  EXPECT_EQ(told.mission().mission(), "run1");
  EXPECT_EQ(told.comparison().revision(), 7u);
  EXPECT_EQ(told.link().bytes_waiting(), 1);
  reporter_->Stop();
  const auto bytes = static_cast<int64_t>(told.ByteSizeLong());
  EXPECT_EQ(counters_.report_bytes_sent, bytes);
  EXPECT_EQ(counters_.bytes_sent, bytes);
}

TEST_F(StatusReporterTest, WithoutComparisonsTheLinkIsToldAtIntervals) {
  settings_.interval = absl::Milliseconds(5);
  Start();
  ASSERT_TRUE(AwaitTold(3));
  for (const v1::ReportStatusRequest& told : Told()) EXPECT_FALSE(told.has_comparison());
}

// The server answers the first call only once others have been asked for.
class SlowServerTest : public StatusReporterTest {
 protected:
  void TearDown() override {
    if (!go_on_.HasBeenNotified()) go_on_.Notify();
    StatusReporterTest::TearDown();
  }
  grpc::Status Answer(int call, v1::ReportStatusResponse& /*response*/) override {
    if (call == 0) {
      called_.Notify();
      go_on_.WaitForNotification();
    }
    return grpc::Status::OK;
  }
  absl::Notification called_, go_on_;
};

TEST_F(SlowServerTest, OneCallIsUnderWayAndTheNewestComparisonWins) {
  Start();
  Compare(1);
  called_.WaitForNotification();
  for (const uint64_t revision : {2, 3, 4}) Compare(revision);  // returns at once
  EXPECT_EQ(Told().size(), 0u);
  go_on_.Notify();
  ASSERT_TRUE(AwaitTold(2));
  reporter_->Stop();
  const std::vector<v1::ReportStatusRequest> told = Told();
  ASSERT_EQ(told.size(), 2u);
  EXPECT_EQ(told[0].comparison().revision(), 1u);
  EXPECT_EQ(told[1].comparison().revision(), 4u);
}

TEST_F(SlowServerTest, StoppingDoesNotWaitForTheServer) {
  Start();
  Compare(1);
  called_.WaitForNotification();
  reporter_->Stop();  // returns
  Compare(2);
  EXPECT_EQ(Told().size(), 0u);
}

class RefusingServerTest : public StatusReporterTest {
 protected:
  grpc::Status Answer(int call, v1::ReportStatusResponse& /*response*/) override {
    return call < 2 ? refusal_ : grpc::Status::OK;
  }
  grpc::Status refusal_;
};

TEST_F(RefusingServerTest, WhatNobodyHeardIsToldAfterTheInterval) {
  refusal_ = grpc::Status(grpc::StatusCode::NOT_FOUND, "map: there is no 'town'");
  settings_.interval = absl::Milliseconds(5);
  Start();
  Compare(9);
  ASSERT_TRUE(AwaitTold(3));
  for (int call : {0, 1, 2}) EXPECT_EQ(Told()[call].comparison().revision(), 9u) << call;
}

TEST_F(RefusingServerTest, AnOlderServerIsNotAskedAgainSoon) {
  for (const grpc::StatusCode code :
       {grpc::StatusCode::UNIMPLEMENTED, grpc::StatusCode::INVALID_ARGUMENT}) {
    refusal_ = grpc::Status(code, "");
    settings_.interval = absl::Milliseconds(1);
    settings_.refused_pause = absl::Hours(1);
    const size_t before = Told().size();
    Start();
    Compare(1);
    ASSERT_TRUE(AwaitTold(before + 1));
    Compare(2);
    EXPECT_FALSE(AwaitTold(before + 2, absl::Milliseconds(200)));
    reporter_.reset();
  }
}

TEST_F(RefusingServerTest, AServerThatWasRenewedIsToldAgain) {
  refusal_ = grpc::Status(grpc::StatusCode::UNIMPLEMENTED, "");
  settings_.interval = absl::Milliseconds(1);
  settings_.refused_pause = absl::Milliseconds(5);
  Start();
  EXPECT_TRUE(AwaitTold(3));
}

TEST_F(StatusReporterTest, AServerThatIsAwayCostsNothingButTheTry) {
  settings_.interval = absl::Milliseconds(1);
  const SilentSocket nobody;
  StartAgainst(nobody.address());
  Compare(1);
  reporter_->Stop();  // returns
}

class CalmServerTest : public StatusReporterTest {
 protected:
  grpc::Status Answer(int /*call*/, v1::ReportStatusResponse& response) override {
    response.set_next_report_s(3000);
    return grpc::Status::OK;
  }
};

TEST_F(CalmServerTest, TheServerSaysHowOften) {
  settings_.interval = absl::Milliseconds(1);
  Start();
  ASSERT_TRUE(AwaitTold(1));
  EXPECT_FALSE(AwaitTold(2, absl::Milliseconds(200)));
  Compare(1);  // that is told as ever
  EXPECT_TRUE(AwaitTold(2));
}

TEST_F(StatusReporterTest, OnASlowLinkReportsKeepToTheirShare) {
  settings_.max_upload_bytes_per_s = 1000;  // 50 of them for reports
  settings_.interval = absl::Seconds(10);
  Start();
  Compare(1, /*nodes=*/5000);
  ASSERT_TRUE(AwaitTold(1));
  EXPECT_LE(Told()[0].ByteSizeLong(), 500u);
  Compare(2, /*nodes=*/5000);
  EXPECT_FALSE(AwaitTold(2, absl::Milliseconds(500)));  // the first is paid off over seconds
}

TEST_F(StatusReporterTest, ALinkInDebtIsWaitedFor) {
  settings_.max_upload_bytes_per_s = 1'000'000;
  Start();
  bucket_->Take(60'000'000, TokenBucket::Clock::now());  // a minute's worth
  Compare(1);
  EXPECT_FALSE(AwaitTold(1, absl::Milliseconds(200)));
}

}  // namespace
}  // namespace overtone
