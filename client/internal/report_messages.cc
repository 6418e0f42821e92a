// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/internal/report_messages.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <vector>

#include "Eigen/Core"
#include "overtone/proto/conversion/proto_time.h"

namespace overtone {
namespace {

// Of a link's capacity, for reports.
constexpr double kShare = 0.05;
// Serialised: the fixed part, and what a node and a constraint's ends take at the most.
constexpr double kFixedBytes = 280;
constexpr double kNodeBytes = 17;
constexpr double kConstraintBytes = 24;
constexpr int kFewestNodes = 10;

// What a server takes: finite, not negative.
double Tellable(double value) {
  constexpr double kLargest = std::numeric_limits<float>::max();
  return std::isnan(value) ? 0 : std::clamp(value, 0.0, kLargest);
}

google::protobuf::Duration ToProto(double seconds) {
  absl::Duration rest = absl::Seconds(seconds);
  google::protobuf::Duration message;
  message.set_seconds(absl::IDivDuration(rest, absl::Seconds(1), &rest));
  message.set_nanos(static_cast<int32_t>(absl::ToInt64Nanoseconds(rest)));
  return message;
}

v1::ConstraintKind ToProto(ConstraintKind kind) {
  switch (kind) {
    case ConstraintKind::kSmall:
      return v1::CONSTRAINT_KIND_SMALL;
    case ConstraintKind::kMid:
      return v1::CONSTRAINT_KIND_MID;
    case ConstraintKind::kLarge:
      return v1::CONSTRAINT_KIND_LARGE;
    case ConstraintKind::kDegenerate:
      return v1::CONSTRAINT_KIND_DEGENERATE;
    case ConstraintKind::kChord:
      return v1::CONSTRAINT_KIND_CHORD;
  }
  return v1::CONSTRAINT_KIND_UNSPECIFIED;
}

// Rows [begin, end) as one node.
void AddStretch(const TrajectoryComparison& comparison, Eigen::Index begin, Eigen::Index end,
                v1::ComparisonReport& message) {
  const auto rows = comparison.discrepancy.middleRows(begin, end - begin);
  Eigen::Index largest = 0;
  rows.rowwise().maxCoeff().maxCoeff(&largest);
  const auto value = [&](Band band) {
    return static_cast<float>(Tellable(rows.col(static_cast<Eigen::Index>(band)).maxCoeff()));
  };
  message.add_index(comparison.keyframe_index[static_cast<size_t>(begin + largest)]);
  message.add_small(value(Band::kSmall));
  message.add_mid(value(Band::kMid));
  message.add_large(value(Band::kLarge));
}

void AddDiscrepancy(const TrajectoryComparison& comparison, int max_nodes,
                    v1::ComparisonReport& message) {
  const Eigen::Index size = comparison.discrepancy.rows();
  const Eigen::Index stretches = std::min<Eigen::Index>(size, max_nodes);
  for (Eigen::Index i = 0; i < stretches; ++i) {
    AddStretch(comparison, i * size / stretches, (i + 1) * size / stretches, message);
  }
}

void SetLevel(const BandLevel& level, v1::BandLevel& message) {
  message.set_noise(Tellable(level.noise));
  message.set_largest(Tellable(level.largest));
  message.set_exceeds(level.exceeds);
}

void AddConstraints(const ConstraintBatch& batch, int max_ends, v1::ComparisonReport& message) {
  std::map<ConstraintKind, int> added;
  for (const Constraint& constraint : batch.add) ++added[constraint.kind];
  for (const auto& [kind, count] : added) {
    v1::ConstraintCount& entry = *message.add_constraints();
    entry.set_kind(ToProto(kind));
    entry.set_added(count);
  }
  std::vector<const Constraint*> asked;
  for (const Constraint& constraint : batch.add) asked.push_back(&constraint);
  for (const Constraint& constraint : batch.update) asked.push_back(&constraint);
  std::stable_sort(asked.begin(), asked.end(), [](const Constraint* a, const Constraint* b) {
    return Tellable(a->score) > Tellable(b->score);
  });
  if (asked.size() > static_cast<size_t>(max_ends)) asked.resize(static_cast<size_t>(max_ends));
  for (const Constraint* constraint : asked) {
    v1::ConstraintEnds& ends = *message.add_largest();
    ends.set_kind(ToProto(constraint->kind));
    ends.set_from(constraint->from);
    ends.set_to(constraint->to);
    ends.set_score(Tellable(constraint->score));
  }
}

}  // namespace

v1::LinkReport ToProto(const MappingClientStats& stats) {
  v1::LinkReport link;
  link.set_submaps_waiting(stats.submaps_waiting);
  link.set_blobs_waiting(stats.blobs_waiting);
  link.set_bytes_waiting(stats.bytes_waiting);
  link.set_bytes_sent(stats.bytes_sent);
  link.set_bytes_received(stats.bytes_received);
  link.set_report_bytes_sent(stats.report_bytes_sent);
  link.set_reconnects(stats.reconnects);
  link.set_clouds_dropped(stats.clouds_dropped);
  if (std::isfinite(stats.clock_offset_s) && std::isfinite(stats.clock_offset_uncertainty_s)) {
    *link.mutable_clock_offset() = ToProto(stats.clock_offset_s);
    *link.mutable_clock_offset_uncertainty() = ToProto(stats.clock_offset_uncertainty_s);
  }
  link.set_outbox_on_disk(stats.outbox_on_disk);
  link.set_client_version(OVERTONE_CLIENT_VERSION);
  return link;
}

ReportDetail ReportDetail::ForLink(int64_t bytes_per_s, absl::Duration interval) {
  ReportDetail detail;
  if (bytes_per_s == 0) return detail;
  const double bytes = kShare * static_cast<double>(bytes_per_s) * absl::ToDoubleSeconds(interval);
  // Two constraints for five nodes, as in a report of full size.
  const double nodes = (bytes - kFixedBytes) / (kNodeBytes + 0.4 * kConstraintBytes);
  detail.max_nodes =
      static_cast<int>(std::clamp<double>(nodes, kFewestNodes, report_limits::kMaxNodes));
  detail.max_constraint_ends = detail.max_nodes * 2 / 5;
  return detail;
}

v1::ComparisonReport ToProto(const SynchronizationReport& report, const ReportDetail& detail,
                             absl::Time now) {
  v1::ComparisonReport message;
  message.set_map_epoch(report.comparison.map_epoch);
  message.set_revision(report.comparison.revision);
  *message.mutable_time() = ToProto(now);
  message.set_nodes(static_cast<int32_t>(report.comparison.keyframe_index.size()));
  message.set_duration_s(Tellable(report.compare_ms / 1000));
  AddDiscrepancy(report.comparison, detail.max_nodes, message);
  AddConstraints(report.batch, detail.max_constraint_ends, message);
  message.set_updated(static_cast<int32_t>(report.batch.update.size()));
  message.set_retracted(static_cast<int32_t>(report.batch.retract.size()));
  message.set_applied(!report.batch.empty() && report.host_status.ok());
  message.set_rmse_before_m(Tellable(report.rmse_before_m));
  message.set_predicted_rmse_m(Tellable(report.predicted_rmse_m));
  message.set_held_back(report.held_back);
  const auto level = [&](Band band) { return report.bands[static_cast<size_t>(band)]; };
  SetLevel(level(Band::kSmall), *message.mutable_small_level());
  SetLevel(level(Band::kMid), *message.mutable_mid_level());
  SetLevel(level(Band::kLarge), *message.mutable_large_level());
  return message;
}

}  // namespace overtone
