// SPDX-License-Identifier: Apache-2.0
// What the dashboard knows of a map at one moment. Immutable once published; requests read it
// without a lock.
#ifndef OVERTONE_SERVICES_DASHBOARD_MAP_VIEW_H_
#define OVERTONE_SERVICES_DASHBOARD_MAP_VIEW_H_

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "Eigen/Core"
#include "absl/status/status.h"
#include "absl/time/time.h"
#include "overtone/services/dashboard/track.h"
#include "overtone/v1/map_admin_service.pb.h"

namespace overtone {

// A track and when it last changed: the version of the view that first had it.
struct VersionedTrack {
  std::shared_ptr<const Track> track = std::make_shared<Track>();
  uint64_t version = 0;
};

struct MissionView {
  uint32_t number = 0;  // stays the same for as long as the process runs
  v1::Mission mission;
  VersionedTrack positions;    // map frame
  VersionedTrack odometry;     // mission frame
  VersionedTrack discrepancy;  // small, mid, large
  v1::StatusReport report;     // the robot's newest, without the columns of its comparison
  bool asked_for_report = false;
  std::string problem;  // why the positions are not those of the revision; mostly empty
};

struct RobotView {
  v1::Robot robot;
  // Over the last seconds, as the server counted them.
  double received_bytes_per_s = 0;
  double sent_bytes_per_s = 0;
};

struct MapView {
  uint64_t version = 0;  // counts publications
  // Of the last round of questions; when it fails, everything else is what it was before.
  absl::Status link = absl::UnavailableError("not asked yet");
  absl::Time refreshed = absl::InfinitePast();
  std::string server_version;
  std::vector<std::string> maps;  // all that the server shows us
  bool map_exists = false;
  v1::MapSummary summary;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  // of positions, map frame
  std::vector<MissionView> missions;
  std::vector<RobotView> robots;
  std::shared_ptr<const std::vector<v1::LoopClosureStatus>> closures =
      std::make_shared<std::vector<v1::LoopClosureStatus>>();
  uint64_t closures_version = 0;
  std::shared_ptr<const std::vector<v1::Revision>> revisions =
      std::make_shared<std::vector<v1::Revision>>();
  uint64_t revisions_version = 0;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_DASHBOARD_MAP_VIEW_H_
