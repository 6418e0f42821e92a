// SPDX-License-Identifier: Apache-2.0
// The client's own state and its last comparison as ReportStatus carries them.
#ifndef OVERTONE_CLIENT_INTERNAL_REPORT_MESSAGES_H_
#define OVERTONE_CLIENT_INTERNAL_REPORT_MESSAGES_H_

#include "absl/time/time.h"
#include "overtone/client/mapping_client.h"
#include "overtone/proto/conversion/report_conversion.h"
#include "overtone/v1/report.pb.h"

namespace overtone {

v1::LinkReport ToProto(const MappingClientStats& stats);

// How much of a comparison is told.
struct ReportDetail {
  int max_nodes = report_limits::kMaxNodes;
  int max_constraint_ends = report_limits::kMaxConstraintEnds;

  // What a link of so many bytes a second carries along every `interval` with a twentieth of its
  // capacity; 0: no bound.
  static ReportDetail ForLink(int64_t bytes_per_s, absl::Duration interval);
};

// Above max_nodes the nodes are cut into so many stretches of equal length. Of each the largest
// value of each band is told, at the node with the largest of all: no peak is lost.
v1::ComparisonReport ToProto(const SynchronizationReport& report, const ReportDetail& detail,
                             absl::Time now);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_INTERNAL_REPORT_MESSAGES_H_
