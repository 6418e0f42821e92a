// SPDX-License-Identifier: Apache-2.0
// Fetches what belongs to single missions, and tells what changed from what only came again.
#ifndef OVERTONE_SERVICES_DASHBOARD_MISSION_TRACKER_H_
#define OVERTONE_SERVICES_DASHBOARD_MISSION_TRACKER_H_

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "overtone/services/dashboard/map_api.h"
#include "overtone/services/dashboard/map_view.h"

namespace overtone {

// Not thread-safe: the mirror's thread owns it.
class MissionTracker {
 public:
  // `max_nodes` of all missions together; beyond it every second, third, ... keyframe is left out.
  MissionTracker(MapApi* api, int64_t max_nodes) : api_(api), max_nodes_(max_nodes) {}

  // Fetches the missions and the poses of each. Tracks that changed take `version`. An error is of
  // the link; what the server says against one mission is in that mission's `problem`.
  absl::Status LoadRevision(uint64_t version);

  // Fetches the comparisons that `robots` announce and those of missions not asked for yet. A
  // server that knows no reports is not asked again before Reconnected().
  absl::Status LoadReports(const std::vector<v1::Robot>& robots, uint64_t version);
  void Reconnected() { knows_reports_ = true; }

  // In the server's order.
  const std::vector<MissionView>& missions() const { return missions_; }
  const Eigen::Vector3d& origin() const { return origin_; }

 private:
  MissionView* Find(const v1::MissionId& id);
  MissionView Known(const v1::Mission& mission);
  absl::Status LoadTracks(int stride, uint64_t version, MissionView& view);
  absl::Status LoadReport(uint64_t version, MissionView& view);
  void ChooseOrigin(const v1::GetTrajectoryResponse& trajectory);

  MapApi* const api_;
  const int64_t max_nodes_;
  std::vector<MissionView> missions_;
  std::map<std::string, uint32_t> numbers_;  // of all that were ever seen, by "robot/mission"
  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();
  bool has_origin_ = false;
  bool knows_reports_ = true;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_DASHBOARD_MISSION_TRACKER_H_
