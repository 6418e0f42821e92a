// SPDX-License-Identifier: Apache-2.0
// What the robots of a map told about themselves, the newest of each mission.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_STATUS_REPORTS_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_STATUS_REPORTS_H_

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "overtone/core/common/ids.h"
#include "overtone/services/mapping_server/metrics/histogram.h"
#include "overtone/v1/map_admin_service.pb.h"
#include "overtone/v1/mapping_service.pb.h"

namespace overtone {

// In memory: forgotten with the process. Thread-safe. Not larger than its caller lets it become:
// only missions that are in the map report.
class StatusReports {
 public:
  using Report = std::shared_ptr<const v1::StatusReport>;

  // The request has been checked. A report without a comparison keeps the one before.
  void Put(const MissionId& mission, const v1::ReportStatusRequest& request, absl::Time now);

  // Null: none.
  Report Get(const MissionId& mission) const;
  // What a robot's reports add up to since the map was opened.
  struct Totals {
    // Constraints that were new, by kind; unknown kinds count as unspecified.
    std::array<uint64_t, v1::ConstraintKind_ARRAYSIZE> constraints{};
  };
  std::map<std::string, Totals> TotalsByRobot() const;
  // Seconds of each comparison, all robots.
  const Histogram<10>& comparison_s() const { return comparison_s_; }

  // The one that came last of all missions of the robot; null: none.
  Report Newest(const std::string& robot) const;

 private:
  mutable absl::Mutex mutex_;
  std::map<MissionId, Report> reports_ ABSL_GUARDED_BY(mutex_);
  std::map<std::string, MissionId> newest_ ABSL_GUARDED_BY(mutex_);  // by robot
  std::map<std::string, Totals> totals_ ABSL_GUARDED_BY(mutex_);     // likewise
  Histogram<10> comparison_s_{{0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1, 3, 10, 30}};
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_STATUS_REPORTS_H_
