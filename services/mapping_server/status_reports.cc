// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/status_reports.h"

#include <utility>

#include "overtone/proto/conversion/id_conversion.h"
#include "overtone/proto/conversion/proto_time.h"

namespace overtone {
namespace {

void Add(const v1::ComparisonReport& comparison, StatusReports::Totals& totals) {
  for (const v1::ConstraintCount& count : comparison.constraints()) {
    const bool known = v1::ConstraintKind_IsValid(count.kind());
    totals.constraints[known ? count.kind() : v1::CONSTRAINT_KIND_UNSPECIFIED] +=
        static_cast<uint64_t>(count.added());
  }
}

}  // namespace

void StatusReports::Put(const MissionId& mission, const v1::ReportStatusRequest& request,
                        absl::Time now) {
  auto report = std::make_shared<v1::StatusReport>();
  *report->mutable_mission() = ToProto(mission);
  *report->mutable_received() = ToProto(now);
  *report->mutable_link() = request.link();
  if (request.has_comparison()) *report->mutable_comparison() = request.comparison();
  // A peer must not park what we do not know with us.
  report->DiscardUnknownFields();
  if (request.has_comparison()) comparison_s_.Observe(request.comparison().duration_s());
  absl::MutexLock lock(&mutex_);
  Totals& totals = totals_[mission.robot];
  if (request.has_comparison()) Add(request.comparison(), totals);
  Report& kept = reports_[mission];
  if (!request.has_comparison() && kept != nullptr && kept->has_comparison()) {
    *report->mutable_comparison() = kept->comparison();
  }
  kept = std::move(report);
  newest_[mission.robot] = mission;
}

std::map<std::string, StatusReports::Totals> StatusReports::TotalsByRobot() const {
  absl::MutexLock lock(&mutex_);
  return totals_;
}

StatusReports::Report StatusReports::Get(const MissionId& mission) const {
  absl::MutexLock lock(&mutex_);
  const auto it = reports_.find(mission);
  return it == reports_.end() ? nullptr : it->second;
}

StatusReports::Report StatusReports::Newest(const std::string& robot) const {
  absl::MutexLock lock(&mutex_);
  const auto it = newest_.find(robot);
  return it == newest_.end() ? nullptr : reports_.at(it->second);
}

}  // namespace overtone
