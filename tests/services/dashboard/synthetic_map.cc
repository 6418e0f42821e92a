// SPDX-License-Identifier: Apache-2.0
#include "overtone/tests/services/dashboard/synthetic_map.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "Eigen/Geometry"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/time/clock.h"
#include "absl/time/time.h"

namespace overtone::testing {
namespace {

using Eigen::Vector3d;

constexpr double kPi = 3.14159265358979;
constexpr double kSpacingM = 0.5;
constexpr double kLapNodes = 450;
constexpr int kReportedNodes = 500;
constexpr uint64_t kEpoch = 7;

google::protobuf::Timestamp Now() {
  google::protobuf::Timestamp time;
  time.set_seconds(absl::ToUnixSeconds(absl::Now()));
  return time;
}

void SetPose(const Vector3d& position, v1::Pose& pose) {
  pose.mutable_position()->set_x(position.x());
  pose.mutable_position()->set_y(position.y());
  pose.mutable_position()->set_z(position.z());
  pose.mutable_orientation()->set_w(1);
}

v1::NodeId Node(const v1::MissionId& mission, int64_t index) {
  v1::NodeId node;
  *node.mutable_mission() = mission;
  node.set_index(index);
  return node;
}

// Laps of a bent oval, a little beside each other.
Vector3d OnTrack(int robot, double node) {
  const double angle = 2 * kPi * node / kLapNodes + robot;
  const double wide = 1 + 0.02 * std::floor(node / kLapNodes);
  return {wide * (38 * std::cos(angle) + 11 * std::cos(3 * angle + robot)),
          wide * (28 * std::sin(angle) + 9 * std::sin(2 * angle + 2 * robot)),
          2.5 * std::sin(angle + robot)};
}

// The place nearest to `point` that is not `from` or within a quarter of a lap of it.
int NearestAhead(const Vector3d& point, const std::vector<Vector3d>& places, int from) {
  int nearest = from == 0 ? 0 : std::max(0, from - static_cast<int>(kLapNodes / 4));
  for (int i = 0; i < static_cast<int>(places.size()); ++i) {
    if (from != 0 && std::abs(i - from) < kLapNodes / 4) continue;
    if ((places[i] - point).norm() < (places[nearest] - point).norm()) nearest = i;
  }
  return nearest;
}

struct Verdict {
  v1::LoopClosureVerdict verdict;
  const char* reason;
};

const Verdict kVerdicts[] = {
    {v1::LOOP_CLOSURE_VERDICT_ACCEPTED,
     "fits the map: weight 0.98, chi-square 4.1 of at most 16.8"},
    {v1::LOOP_CLOSURE_VERDICT_ACCEPTED,
     "fits the map: weight 1.00, chi-square 1.7 of at most 16.8"},
    {v1::LOOP_CLOSURE_VERDICT_ACCEPTED,
     "fits the map: weight 0.99, chi-square 3.0 of at most 16.8"},
    {v1::LOOP_CLOSURE_VERDICT_REJECTED_OVERLAP,
     "the registered clouds share 31 % of their points; 60 % are needed"},
    {v1::LOOP_CLOSURE_VERDICT_QUARANTINED,
     "would tie two components, and 1 of 3 closures that are needed agrees with it yet"},
    {v1::LOOP_CLOSURE_VERDICT_DEMOTED_BY_OPTIMISER,
     "contradicts the rest of the map: its weight went to zero"},
};

}  // namespace

SyntheticMap::SyntheticMap(const SyntheticMapOptions& options) : options_(options) {
  for (int robot = 0; robot < options.robots; ++robot) paths_.push_back(MakePath(robot));
  for (int robot = 0; robot < options.robots; ++robot) MakeClosures(robot);
  AddRevision(0);
}

SyntheticMap::Path SyntheticMap::MakePath(int robot) const {
  Path path;
  path.id.set_robot(absl::StrFormat("robot%02d", robot + 1));
  path.id.set_mission("run1");
  const bool last_of_many = options_.robots >= 5 && robot == options_.robots - 1;
  path.anchored = !last_of_many && robot % 25 != 24;
  const int side = static_cast<int>(std::ceil(std::sqrt(options_.robots)));
  const Vector3d centre(45.0 * (robot % side), 45.0 * (robot / side), 0);  // NOLINT: whole rows
  for (int i = 0; i < options_.nodes; ++i) path.truth.push_back(centre + OnTrack(robot, i));
  // Each step turned a little further, as by a gyroscope's bias.
  path.odometry.push_back(Vector3d::Zero());
  for (int i = 1; i < options_.nodes; ++i) {
    const double yaw = 6e-4 * i * (robot % 2 == 0 ? 1 : -1);
    path.odometry.push_back(path.odometry.back() + Eigen::AngleAxisd(yaw, Vector3d::UnitZ()) *
                                                       (path.truth[i] - path.truth[i - 1]));
  }
  return path;
}

void SyntheticMap::MakeClosures(int robot) {
  const Path& path = paths_[robot];
  const Path& other = paths_[(robot + 1) % paths_.size()];
  for (int i = 0; i < options_.closures_per_robot; ++i) {
    const Verdict& verdict = kVerdicts[i % std::size(kVerdicts)];
    const int from = (options_.nodes - 1) * (i + 1) / (options_.closures_per_robot + 1);
    const bool within = i % 2 == 0;
    const Path& there = within ? path : other;
    const bool wrong = verdict.verdict == v1::LOOP_CLOSURE_VERDICT_REJECTED_OVERLAP;
    const int to =
        wrong ? from / 3 : NearestAhead(path.truth[from], there.truth, within ? from : 0);
    v1::LoopClosureStatus closure;
    *closure.mutable_loop_closure()->mutable_from() = Node(path.id, from);
    *closure.mutable_loop_closure()->mutable_to() = Node(there.id, to);
    closure.set_verdict(verdict.verdict);
    closure.set_reason(verdict.reason);
    closure.set_id(
        absl::StrCat(path.id.robot(), "/run1:", from, ">", there.id.robot(), "/run1:", to, "#0"));
    const bool used = verdict.verdict == v1::LOOP_CLOSURE_VERDICT_ACCEPTED;
    closure.set_weight(used ? 0.98 : 0);
    closure.set_chi_square(used ? 4.1 : 61.3);
    closure.set_proposer(v1::LOOP_CLOSURE_PROPOSER_SCAN_CONTEXT);
    closure.set_score(0.81);
    closure.set_score_threshold(0.6);
    closure.set_measured(true);
    closure.set_since_revision(1);
    v1::RegistrationFigures& figures = *closure.mutable_registration();
    figures.set_overlap(used ? 0.84 : 0.31);
    figures.set_overlap_threshold(0.6);
    figures.set_residual_m(used ? 0.043 : 0.21);
    figures.set_residual_limit_m(0.25);
    figures.set_converged(true);
    closures_.push_back(closure);
  }
}

void SyntheticMap::AddRevision(int accepted) {
  v1::Revision revision;
  revision.set_revision(revision_);
  revision.set_map_epoch(kEpoch);
  *revision.mutable_published() = Now();
  revision.set_missions(static_cast<int>(paths_.size()));
  revision.set_anchored_missions(static_cast<int>(
      std::count_if(paths_.begin(), paths_.end(), [](const Path& path) { return path.anchored; })));
  revision.set_keyframes(static_cast<int64_t>(paths_.size()) * options_.nodes);
  for (int i = 0; i < accepted; ++i) *revision.add_accepted() = closures_[i].id();
  revision.set_mean_move_m(0.8 * std::exp(-0.2 * static_cast<double>(revision_)));
  revision.set_largest_move_m(4 * revision.mean_move_m());
  const double busy = 1 + 0.3 * std::sin(static_cast<double>(revision_));
  revision.set_optimisation_s(0.21 * busy);
  for (const auto& [stage, seconds] :
       {std::make_pair("intake", 0.012), std::make_pair("optimise", 0.21),
        std::make_pair("snapshot", 0.03), std::make_pair("store", 0.018),
        std::make_pair("publish", 0.009)}) {
    v1::StageTime& time = *revision.add_stages();
    time.set_stage(stage);
    time.set_seconds(busy * seconds);
  }
  revisions_.insert(revisions_.begin(), revision);
  if (revisions_.size() > 1000) revisions_.pop_back();
}

void SyntheticMap::Advance() {
  ++revision_;
  AddRevision(closures_.empty() ? 0 : 1);
}

bool SyntheticMap::Veto(const std::string& id) {
  for (v1::LoopClosureStatus& closure : closures_) {
    if (closure.id() != id) continue;
    closure.set_verdict(v1::LOOP_CLOSURE_VERDICT_VETOED_BY_OPERATOR);
    closure.set_reason("an operator vetoed it");
    closure.set_weight(0);
    closure.set_since_revision(revision_ + 1);
    Advance();
    return true;
  }
  return false;
}

Vector3d SyntheticMap::Estimate(const Path& path, int index) const {
  const Vector3d uncorrected = path.truth[0] + path.odometry[index];
  if (!path.anchored) return uncorrected;
  const double left = std::exp(-0.2 * static_cast<double>(revision_ - 1));
  return path.truth[index] + left * (uncorrected - path.truth[index]);
}

const SyntheticMap::Path* SyntheticMap::Find(const v1::MissionId& id) const {
  const auto found = std::find_if(paths_.begin(), paths_.end(), [&id](const Path& path) {
    return path.id.robot() == id.robot() && path.id.mission() == id.mission();
  });
  return found == paths_.end() ? nullptr : &*found;
}

v1::MapSummary SyntheticMap::Summary(const std::string& map) const {
  v1::MapSummary summary;
  summary.set_map(map);
  summary.set_map_epoch(kEpoch);
  summary.set_revision(revision_);
  summary.set_missions(static_cast<int>(paths_.size()));
  summary.set_keyframes(static_cast<int64_t>(paths_.size()) * options_.nodes);
  summary.set_loop_closures(static_cast<int64_t>(closures_.size()));
  summary.set_components(revisions_[0].missions() - revisions_[0].anchored_missions() + 1);
  *summary.mutable_published() = revisions_[0].published();
  summary.set_optimisation_s(revisions_[0].optimisation_s());
  summary.set_clouds(static_cast<int64_t>(paths_.size()) * options_.nodes / 4);
  return summary;
}

std::vector<v1::Robot> SyntheticMap::Robots() const {
  std::vector<v1::Robot> robots;
  for (size_t i = 0; i < paths_.size(); ++i) {
    v1::Robot robot;
    robot.set_robot(paths_[i].id.robot());
    robot.set_missions(1);
    robot.set_keyframes(options_.nodes);
    const bool away = i % 7 == 3;
    robot.set_uploading(!away);
    robot.set_watching(!away);
    robot.set_revision_sent(revision_);
    *robot.mutable_last_upload() = Now();
    if (away) robot.mutable_last_upload()->set_seconds(Now().seconds() - 340);
    robot.set_bytes_received(static_cast<int64_t>(revision_) * 182'000 * (1 + i % 3));
    robot.set_bytes_sent(static_cast<int64_t>(revision_) * 9'500);
    v1::StatusReport report;
    if (Report(paths_[i].id, report)) {
      for (auto* column : {report.mutable_comparison()->mutable_small(),
                           report.mutable_comparison()->mutable_mid(),
                           report.mutable_comparison()->mutable_large()}) {
        column->Clear();
      }
      report.mutable_comparison()->clear_index();
      report.mutable_comparison()->clear_largest();
      *robot.mutable_report() = report;
    }
    robots.push_back(robot);
  }
  return robots;
}

std::vector<v1::Mission> SyntheticMap::Missions() const {
  std::vector<v1::Mission> missions;
  int component = 0;
  for (const Path& path : paths_) {
    v1::Mission mission;
    *mission.mutable_id() = path.id;
    mission.set_anchored(path.anchored);
    mission.set_component(path.anchored ? 0 : ++component);
    mission.set_submaps(options_.nodes / 20);
    mission.set_keyframes(options_.nodes);
    mission.set_last_stamp_ns(static_cast<int64_t>(options_.nodes) * 500'000'000);
    mission.set_path_m(kSpacingM * options_.nodes);
    SetPose(path.truth[0], *mission.mutable_map_tform_mission());
    missions.push_back(mission);
  }
  return missions;
}

bool SyntheticMap::Trajectory(const v1::MissionId& id, bool odometry,
                              v1::GetTrajectoryResponse& response) const {
  const Path* path = Find(id);
  if (path == nullptr) return false;
  response.set_map_epoch(kEpoch);
  response.set_revision(revision_);
  response.set_anchored(path->anchored);
  for (int i = 0; i < options_.nodes; ++i) {
    v1::Node& node = *response.add_nodes();
    node.set_index(i);
    SetPose(Estimate(*path, i), *node.mutable_map_tform_body());
    if (odometry) SetPose(path->odometry[i], *response.add_odometry());
  }
  return true;
}

bool SyntheticMap::Report(const v1::MissionId& id, v1::StatusReport& report) const {
  const Path* path = Find(id);
  if (path == nullptr) return false;
  *report.mutable_mission() = id;
  *report.mutable_received() = Now();
  v1::LinkReport& link = *report.mutable_link();
  const bool behind = id.robot().back() == '4';
  link.set_submaps_waiting(behind ? 17 : 0);
  link.set_blobs_waiting(behind ? 41 : 0);
  link.set_bytes_waiting(behind ? 6'300'000 : 0);
  link.mutable_clock_offset()->set_nanos(3'200'000);
  link.mutable_clock_offset_uncertainty()->set_nanos(1'100'000);
  v1::ComparisonReport& comparison = *report.mutable_comparison();
  comparison.set_map_epoch(kEpoch);
  comparison.set_revision(revision_);
  *comparison.mutable_time() = revisions_[0].published();
  comparison.set_nodes(options_.nodes);
  comparison.set_applied(true);
  const int stride = std::max(1, options_.nodes / kReportedNodes);
  for (int i = 0; i < options_.nodes; i += stride) {
    const double off_m = (path->truth[0] + path->odometry[i] - Estimate(*path, i)).norm();
    comparison.add_index(i);
    comparison.add_small(static_cast<float>(0.05 * off_m * (1 + std::sin(0.3 * i))));
    comparison.add_mid(static_cast<float>(0.2 * off_m * (1 + std::sin(0.05 * i))));
    comparison.add_large(static_cast<float>(0.6 * off_m));
  }
  for (int i = 0; i < 8; ++i) {
    v1::ConstraintEnds& ends = *comparison.add_largest();
    ends.set_kind(v1::CONSTRAINT_KIND_CHORD);
    ends.set_from(i * (options_.nodes - 1) / 8);
    ends.set_to((i + 1) * (options_.nodes - 1) / 8);
    ends.set_score(1.0 / (i + 1));
  }
  v1::ConstraintCount& count = *comparison.add_constraints();
  count.set_kind(v1::CONSTRAINT_KIND_CHORD);
  count.set_added(8);
  comparison.set_rmse_before_m(1.42);
  comparison.set_predicted_rmse_m(0.061);
  return true;
}

std::string SyntheticMap::Ply(double voxel_m, int64_t max_points) const {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  const int64_t points = std::min<int64_t>(max_points, options_.cloud_points);
  std::string file = absl::StrCat(
      "ply\nformat binary_little_endian 1.0\ncomment voxel ", voxel_m, " m\nelement vertex ",
      points,
      "\nproperty float x\nproperty float y\nproperty float z\nproperty float intensity\n"
      "end_header\n");
  for (int64_t i = 0; i < points; ++i) {
    const Path& path = paths_[i % paths_.size()];
    const Vector3d& near = path.truth[(i * 7919) % path.truth.size()];
    const double side = 4 + 0.3 * normal(random);
    const double angle = 2 * kPi * static_cast<double>(i) / 61.0;
    const float row[4] = {static_cast<float>(near.x() + side * std::cos(angle)),
                          static_cast<float>(near.y() + side * std::sin(angle)),
                          static_cast<float>(near.z() + 3 * std::abs(normal(random)) - 1), 1.0f};
    file.append(reinterpret_cast<const char*>(row), sizeof(row));
  }
  return file;
}

}  // namespace overtone::testing
