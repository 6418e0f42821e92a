// SPDX-License-Identifier: Apache-2.0
// A map that no robot drove, as large as a test wants it, with all that a server can say of one:
// odometry, reports, closures of every verdict, clouds, revisions in which it straightens itself.
#ifndef OVERTONE_TESTS_SERVICES_DASHBOARD_SYNTHETIC_MAP_H_
#define OVERTONE_TESTS_SERVICES_DASHBOARD_SYNTHETIC_MAP_H_

#include <cstdint>
#include <string>
#include <vector>

#include "Eigen/Core"
#include "overtone/v1/map_admin_service.pb.h"

namespace overtone::testing {

struct SyntheticMapOptions {
  int robots = 4;  // one mission each; the last of five or more, and every 25th, is not in the map
  int nodes = 600;
  int closures_per_robot = 12;
  int cloud_points = 20'000;
};

class SyntheticMap {
 public:
  explicit SyntheticMap(const SyntheticMapOptions& options);

  // The next optimisation: every pose comes closer to where it belongs.
  void Advance();
  uint64_t revision() const { return revision_; }
  // False: no such closure.
  bool Veto(const std::string& id);

  v1::MapSummary Summary(const std::string& map) const;
  std::vector<v1::Robot> Robots() const;
  std::vector<v1::Mission> Missions() const;
  const std::vector<v1::LoopClosureStatus>& closures() const { return closures_; }
  const std::vector<v1::Revision>& revisions() const { return revisions_; }  // newest first
  // False: no such mission.
  bool Trajectory(const v1::MissionId& id, bool odometry,
                  v1::GetTrajectoryResponse& response) const;
  bool Report(const v1::MissionId& id, v1::StatusReport& report) const;
  std::string Ply(double voxel_m, int64_t max_points) const;

 private:
  struct Path {
    v1::MissionId id;
    bool anchored = true;
    std::vector<Eigen::Vector3d> truth;     // map frame
    std::vector<Eigen::Vector3d> odometry;  // mission frame: it begins at the origin
  };
  Path MakePath(int robot) const;
  void MakeClosures(int robot);
  void AddRevision(int accepted);
  // Of a keyframe in the present revision.
  Eigen::Vector3d Estimate(const Path& path, int index) const;
  const Path* Find(const v1::MissionId& id) const;

  const SyntheticMapOptions options_;
  uint64_t revision_ = 1;
  std::vector<Path> paths_;
  std::vector<v1::LoopClosureStatus> closures_;
  std::vector<v1::Revision> revisions_;
};

}  // namespace overtone::testing

#endif  // OVERTONE_TESTS_SERVICES_DASHBOARD_SYNTHETIC_MAP_H_
