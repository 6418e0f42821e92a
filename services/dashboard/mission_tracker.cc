// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/dashboard/mission_tracker.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {
namespace {

// What moved less is not sent to browsers again.
constexpr float kToleranceM = 1e-3f;
// Positions this far from the map's origin lose millimetres as floats.
constexpr double kFarM = 10'000;

bool IsSame(const v1::MissionId& a, const v1::MissionId& b) {
  return a.robot() == b.robot() && a.mission() == b.mission();
}

// Said about one mission, and no reason to doubt the rest.
bool ConcernsOneMission(const absl::Status& status) {
  return absl::IsNotFound(status) || absl::IsResourceExhausted(status) ||
         absl::IsInvalidArgument(status);
}

void Replace(Track track, float tolerance, uint64_t version, VersionedTrack& versioned) {
  if (AreAlike(track, *versioned.track, tolerance)) return;
  versioned.track = std::make_shared<const Track>(std::move(track));
  versioned.version = version;
}

bool IsNewer(const v1::ComparisonReport& announced, const v1::ComparisonReport& known) {
  return announced.map_epoch() != known.map_epoch() || announced.revision() != known.revision() ||
         announced.time().seconds() != known.time().seconds() ||
         announced.time().nanos() != known.time().nanos();
}

// They are in the track.
void DropColumns(v1::ComparisonReport& comparison) {
  comparison.clear_index();
  comparison.clear_small();
  comparison.clear_mid();
  comparison.clear_large();
}

}  // namespace

MissionView* MissionTracker::Find(const v1::MissionId& id) {
  const auto found =
      std::find_if(missions_.begin(), missions_.end(),
                   [&id](const MissionView& view) { return IsSame(view.mission.id(), id); });
  return found == missions_.end() ? nullptr : &*found;
}

MissionView MissionTracker::Known(const v1::Mission& mission) {
  const MissionView* known = Find(mission.id());
  MissionView view = known == nullptr ? MissionView() : *known;
  if (known == nullptr) {
    const std::string key = absl::StrCat(mission.id().robot(), "/", mission.id().mission());
    view.number = numbers_.emplace(key, static_cast<uint32_t>(numbers_.size())).first->second;
  }
  view.mission = mission;
  return view;
}

absl::Status MissionTracker::LoadRevision(uint64_t version) {
  ASSIGN_OR_RETURN(const std::vector<v1::Mission> missions, api_->Missions());
  int64_t keyframes = 0;
  for (const v1::Mission& mission : missions) keyframes += mission.keyframes();
  const int stride = static_cast<int>((keyframes + max_nodes_ - 1) / max_nodes_);
  std::vector<MissionView> views;
  for (const v1::Mission& mission : missions) {
    views.push_back(Known(mission));
    RETURN_IF_ERROR(LoadTracks(std::max(1, stride), version, views.back()));
  }
  missions_ = std::move(views);
  return absl::OkStatus();
}

absl::Status MissionTracker::LoadTracks(int stride, uint64_t version, MissionView& view) {
  const auto trajectory = api_->Trajectory(view.mission.id());
  view.problem = trajectory.ok() ? "" : std::string(trajectory.status().message());
  if (!trajectory.ok()) {
    return ConcernsOneMission(trajectory.status()) ? absl::OkStatus() : trajectory.status();
  }
  ChooseOrigin(*trajectory);
  Replace(MapPositions(*trajectory, origin_, stride), kToleranceM, version, view.positions);
  Replace(OdometryPositions(*trajectory, stride), 0, version, view.odometry);
  return absl::OkStatus();
}

// Once, since tracks that did not change are not sent again. Whole kilometres, so that people
// recognise the coordinates.
void MissionTracker::ChooseOrigin(const v1::GetTrajectoryResponse& trajectory) {
  if (has_origin_ || trajectory.nodes().empty() || !trajectory.anchored()) return;
  has_origin_ = true;
  const v1::Vector3& first = trajectory.nodes(0).map_tform_body().position();
  const Eigen::Vector3d position(first.x(), first.y(), first.z());
  if (position.norm() > kFarM) origin_ = 1000 * (position / 1000).array().round().matrix();
}

absl::Status MissionTracker::LoadReports(const std::vector<v1::Robot>& robots, uint64_t version) {
  for (const v1::Robot& robot : robots) {
    MissionView* view = robot.has_report() ? Find(robot.report().mission()) : nullptr;
    if (view == nullptr) continue;
    const bool newer = robot.report().has_comparison() &&
                       IsNewer(robot.report().comparison(), view->report.comparison());
    if (newer) {
      RETURN_IF_ERROR(LoadReport(version, *view));
    } else {
      *view->report.mutable_link() = robot.report().link();
      *view->report.mutable_received() = robot.report().received();
    }
  }
  for (MissionView& view : missions_) {
    if (!view.asked_for_report) RETURN_IF_ERROR(LoadReport(version, view));
  }
  return absl::OkStatus();
}

absl::Status MissionTracker::LoadReport(uint64_t version, MissionView& view) {
  if (!knows_reports_) return absl::OkStatus();
  absl::StatusOr<v1::StatusReport> report = api_->Report(view.mission.id());
  if (absl::IsUnimplemented(report.status())) knows_reports_ = false;  // an older server
  view.asked_for_report = knows_reports_;
  if (!report.ok()) {
    const bool is_answer = !knows_reports_ || ConcernsOneMission(report.status());
    return is_answer ? absl::OkStatus() : report.status();
  }
  Replace(Discrepancy(report->comparison()), 0, version, view.discrepancy);
  view.report = *std::move(report);
  if (view.report.has_comparison()) DropColumns(*view.report.mutable_comparison());
  return absl::OkStatus();
}

}  // namespace overtone
