// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/internal/report_messages.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace overtone {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// A flat discrepancy with one peak in each band, at nodes of their own; every third keyframe.
SynchronizationReport ReportOf(int nodes) {
  SynchronizationReport report;
  report.comparison.discrepancy = Eigen::MatrixXd::Constant(nodes, 3, 0.01);
  for (int i = 0; i < nodes; ++i) report.comparison.keyframe_index.push_back(3 * i);
  report.comparison.discrepancy(nodes / 3, static_cast<int>(Band::kSmall)) = 5;
  report.comparison.discrepancy(nodes / 2, static_cast<int>(Band::kMid)) = 6;
  report.comparison.discrepancy(nodes - 1, static_cast<int>(Band::kLarge)) = 7;
  report.comparison.revision = 12;
  report.comparison.map_epoch = 99;
  report.compare_ms = 250;
  return report;
}

Constraint ConstraintOf(ConstraintKind kind, int64_t from, double score) {
  Constraint constraint;
  constraint.kind = kind;
  constraint.from = from;
  constraint.to = from + 1;
  constraint.score = score;
  return constraint;
}

template <typename Column>
int64_t IndexOfLargest(const v1::ComparisonReport& message, const Column& column) {
  return message.index(
      static_cast<int>(std::max_element(column.begin(), column.end()) - column.begin()));
}

TEST(ReportMessages, AShortComparisonIsToldNodeByNode) {
  const absl::Time now = absl::FromUnixNanos(1'700'000'000'123'456'789);
  const v1::ComparisonReport message = ToProto(ReportOf(6), ReportDetail(), now);
  EXPECT_THAT(message.index(), ElementsAre(0, 3, 6, 9, 12, 15));
  EXPECT_THAT(message.small(), ElementsAre(0.01f, 0.01f, 5, 0.01f, 0.01f, 0.01f));
  EXPECT_THAT(message.mid(), ElementsAre(0.01f, 0.01f, 0.01f, 6, 0.01f, 0.01f));
  EXPECT_THAT(message.large(), ElementsAre(0.01f, 0.01f, 0.01f, 0.01f, 0.01f, 7));
  EXPECT_EQ(message.nodes(), 6);
  EXPECT_EQ(message.revision(), 12u);
  EXPECT_EQ(message.map_epoch(), 99u);
  EXPECT_DOUBLE_EQ(message.duration_s(), 0.25);
  EXPECT_EQ(message.time().seconds(), 1'700'000'000);
  EXPECT_EQ(message.time().nanos(), 123'456'789);
}

TEST(ReportMessages, ThinningKeepsEveryPeakWhereItIs) {
  for (const int nodes : {500, 501, 999, 20'000}) {
    const v1::ComparisonReport message = ToProto(ReportOf(nodes), ReportDetail(), absl::Now());
    EXPECT_EQ(message.index_size(), report_limits::kMaxNodes) << nodes;
    EXPECT_EQ(message.nodes(), nodes);
    EXPECT_EQ(IndexOfLargest(message, message.small()), 3 * (nodes / 3)) << nodes;
    EXPECT_EQ(IndexOfLargest(message, message.mid()), 3 * (nodes / 2)) << nodes;
    EXPECT_EQ(IndexOfLargest(message, message.large()), 3 * (nodes - 1)) << nodes;
    EXPECT_TRUE(Validate(message).ok()) << Validate(message);
    EXPECT_LT(message.ByteSizeLong(), 10'000u);
  }
}

TEST(ReportMessages, ConstraintsAreCountedByKindAndTheLargestNamed) {
  SynchronizationReport report = ReportOf(4);
  for (int i = 0; i < 300; ++i) {
    report.batch.add.push_back(
        ConstraintOf(i % 3 == 0 ? ConstraintKind::kMid : ConstraintKind::kLarge, i, i));
  }
  report.batch.update.push_back(ConstraintOf(ConstraintKind::kSmall, 7777, 1e6));
  report.batch.retract = {"mid:1-2", "mid:2-3"};
  const v1::ComparisonReport message = ToProto(report, ReportDetail(), absl::Now());
  ASSERT_EQ(message.constraints_size(), 2);
  for (const v1::ConstraintCount& count : message.constraints()) {
    EXPECT_EQ(count.added(), count.kind() == v1::CONSTRAINT_KIND_MID ? 100 : 200);
  }
  ASSERT_EQ(message.largest_size(), report_limits::kMaxConstraintEnds);
  EXPECT_EQ(message.largest(0).from(), 7777);
  EXPECT_EQ(message.largest(0).kind(), v1::CONSTRAINT_KIND_SMALL);
  EXPECT_EQ(message.largest(1).from(), 299);
  EXPECT_EQ(message.largest(199).from(), 101);
  EXPECT_EQ(message.updated(), 1);
  EXPECT_EQ(message.retracted(), 2);
  EXPECT_TRUE(message.applied());
  EXPECT_TRUE(Validate(message).ok()) << Validate(message);
}

TEST(ReportMessages, WhatTheHostDidNotApplyIsNotApplied) {
  SynchronizationReport report = ReportOf(4);
  EXPECT_FALSE(ToProto(report, ReportDetail(), absl::Now()).applied());  // nothing to apply
  report.batch.add.push_back(ConstraintOf(ConstraintKind::kMid, 1, 1));
  report.host_status = absl::UnavailableError("the host is out of order");
  EXPECT_FALSE(ToProto(report, ReportDetail(), absl::Now()).applied());
}

TEST(ReportMessages, WhatWasPredictedAndWhyNothingWasAskedIsTold) {
  SynchronizationReport report;
  report.rmse_before_m = 0.25;
  report.predicted_rmse_m = 0.5;
  report.held_back = "it would do harm";
  const v1::ComparisonReport message = ToProto(report, ReportDetail(), absl::Now());
  EXPECT_EQ(message.rmse_before_m(), 0.25);
  EXPECT_EQ(message.predicted_rmse_m(), 0.5);
  EXPECT_EQ(message.held_back(), "it would do harm");
}

TEST(ReportMessages, EachBandSaysWhetherItExceedsItsNoise) {
  SynchronizationReport report;
  report.bands[static_cast<size_t>(Band::kMid)] = {0.02, 3, false};
  report.bands[static_cast<size_t>(Band::kLarge)] = {0.5, 11, true};
  const v1::ComparisonReport message = ToProto(report, ReportDetail(), absl::Now());
  EXPECT_EQ(message.mid_level().noise(), 0.02);
  EXPECT_EQ(message.mid_level().largest(), 3);
  EXPECT_FALSE(message.mid_level().exceeds());
  EXPECT_EQ(message.large_level().largest(), 11);
  EXPECT_TRUE(message.large_level().exceeds());
  EXPECT_TRUE(message.small_level().exceeds());  // nothing is known
  EXPECT_TRUE(Validate(message).ok()) << Validate(message);
}

TEST(ReportMessages, WhatIsNoNumberIsStillTakenByTheServer) {
  SynchronizationReport report = ReportOf(4);
  report.comparison.discrepancy.setConstant(kNan);
  report.comparison.discrepancy(1, 1) = 1e300;
  report.batch.add.push_back(ConstraintOf(ConstraintKind::kMid, 1, kNan));
  report.compare_ms = kNan;
  const v1::ComparisonReport message = ToProto(report, ReportDetail(), absl::Now());
  EXPECT_TRUE(Validate(message).ok()) << Validate(message);
  EXPECT_THAT(message.small(), Each(0));
}

TEST(ReportMessages, TheLinkIsToldAsItIs) {
  MappingClientStats stats;
  stats.bytes_waiting = 17;
  stats.report_bytes_sent = 18;
  stats.outbox_on_disk = true;
  v1::LinkReport link = ToProto(stats);
  EXPECT_FALSE(link.has_clock_offset());  // not known
  stats.clock_offset_s = -1.25;
  stats.clock_offset_uncertainty_s = 0.5;
  link = ToProto(stats);
  EXPECT_EQ(link.bytes_waiting(), 17);
  EXPECT_EQ(link.report_bytes_sent(), 18);
  EXPECT_TRUE(link.outbox_on_disk());
  EXPECT_EQ(link.clock_offset().seconds(), -1);
  EXPECT_EQ(link.clock_offset().nanos(), -250'000'000);
  EXPECT_EQ(link.clock_offset_uncertainty().nanos(), 500'000'000);
  EXPECT_TRUE(Validate(link).ok()) << Validate(link);
  EXPECT_NE(link.client_version(), "");
}

TEST(ReportMessages, ASlowLinkCarriesFewerNodes) {
  const ReportDetail unbounded = ReportDetail::ForLink(0, absl::Seconds(10));
  EXPECT_EQ(unbounded.max_nodes, report_limits::kMaxNodes);
  EXPECT_EQ(unbounded.max_constraint_ends, report_limits::kMaxConstraintEnds);
  EXPECT_EQ(ReportDetail::ForLink(1 << 20, absl::Seconds(10)).max_nodes, report_limits::kMaxNodes);
  SynchronizationReport report = ReportOf(5000);
  for (int i = 0; i < 300; ++i) {
    report.batch.add.push_back(ConstraintOf(ConstraintKind::kMid, 1'000'000 + i, i));
  }
  for (const int64_t bytes_per_s : {2000, 5000, 20'000}) {
    const ReportDetail detail = ReportDetail::ForLink(bytes_per_s, absl::Seconds(10));
    const v1::ComparisonReport message = ToProto(report, detail, absl::Now());
    EXPECT_LE(message.ByteSizeLong(), bytes_per_s / 2) << bytes_per_s;  // 5 % of ten seconds
    EXPECT_EQ(*std::max_element(message.large().begin(), message.large().end()), 7);
  }
}

}  // namespace
}  // namespace overtone
