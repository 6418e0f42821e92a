// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/report_data.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "absl/strings/str_replace.h"
#include "nlohmann/json.hpp"
#include "overtone/client/cli/report_decimation.h"
#include "overtone/client/cli/report_heat_map.h"
#include "overtone/core/geometry/rigid_alignment.h"

namespace overtone {
namespace {

using nlohmann::json;

// What all robots share: the report's size does not grow with their number.
constexpr int kMaxPoints = 3000;  // per line
constexpr int kMaxConstraints = 2000;
constexpr int kMaxClosures = 1000;
constexpr int kMaxHeatColumns = 600;
constexpr int kMaxHeatRows = 180;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// To one part in `parts_per_unit`; so divided, it prints in few digits.
json Rounded(double value, double parts_per_unit) {
  const double rounded = std::round(value * parts_per_unit) / parts_per_unit;
  return std::isfinite(rounded) ? json(rounded) : json(nullptr);
}

using Positions = std::vector<Eigen::Vector3d>;  // one for each keyframe, NaN where there is none

// A robot's keyframes in the map frame.
struct DrawnRobot {
  Positions onboard, server, corrected, truth;
  std::vector<double> time_s;
  std::vector<double> path_m;  // along the odometry, where it is known
};

Positions Transform(const Rigid3d& map_from_estimate, const Positions& positions) {
  Positions transformed;
  for (const Eigen::Vector3d& position : positions) {
    transformed.push_back(map_from_estimate * position);
  }
  return transformed;
}

Positions PositionsOf(const std::vector<Rigid3d>& poses, size_t count) {
  Positions positions(count, Eigen::Vector3d::Constant(kNan));
  for (size_t i = 0; i < std::min(count, poses.size()); ++i) positions[i] = poses[i].translation;
  return positions;
}

Positions PositionsOf(const std::vector<std::optional<Rigid3d>>& poses, size_t count) {
  Positions positions(count, Eigen::Vector3d::Constant(kNan));
  for (size_t i = 0; i < std::min(count, poses.size()); ++i) {
    if (poses[i]) positions[i] = poses[i]->translation;
  }
  return positions;
}

// The identity where nothing can be aligned.
Rigid3d Align(const Positions& source, const Positions& target) {
  Positions a, b;
  for (size_t i = 0; i < source.size(); ++i) {
    if (!source[i].allFinite() || !target[i].allFinite()) continue;
    a.push_back(source[i]);
    b.push_back(target[i]);
  }
  return UmeyamaAlignment(a, b, AlignmentMode::kSe3).value_or(Rigid3d());
}

DrawnRobot Draw(const RobotResult& robot) {
  const size_t count = robot.stamps.size();
  DrawnRobot drawn;
  drawn.onboard = PositionsOf(robot.onboard, count);
  drawn.server = PositionsOf(robot.server, count);
  drawn.corrected = PositionsOf(robot.corrected, count);
  drawn.truth = PositionsOf(robot.ground_truth, count);
  const Positions& way = robot.onboard.empty() ? drawn.server : drawn.onboard;
  for (size_t i = 0; i < count; ++i) {
    drawn.time_s.push_back(SecondsBetween(robot.stamps[0], robot.stamps[i]));
    const double step_m = i == 0 ? 0 : (way[i] - way[i - 1]).norm();
    drawn.path_m.push_back((i == 0 ? 0 : drawn.path_m[i - 1]) +
                           (std::isfinite(step_m) ? step_m : 0));
  }
  const Rigid3d map_from_truth = robot.server_error
                                     ? robot.server_error->reference_from_estimate.Inverse()
                                     : Align(drawn.truth, drawn.server);
  const auto place = [&](Positions& positions, const std::optional<TrajectoryError>& error) {
    positions = Transform(
        error ? map_from_truth * error->reference_from_estimate : Align(positions, drawn.server),
        positions);
  };
  place(drawn.onboard, robot.onboard_error);
  place(drawn.corrected, robot.corrected_error);
  drawn.truth = Transform(map_from_truth, drawn.truth);
  return drawn;
}

// The two axes to draw: all but the one along which the team moves least. Camera frames have their
// vertical along y.
std::pair<int, int> TopViewAxes(const std::vector<DrawnRobot>& robots) {
  Eigen::Array3d low = Eigen::Array3d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Array3d high = -low;
  for (const DrawnRobot& robot : robots) {
    for (const Eigen::Vector3d& position : robot.server) {
      if (!position.allFinite()) continue;
      low = low.min(position.array());
      high = high.max(position.array());
    }
  }
  int least = 0;
  (high - low).minCoeff(&least);
  if (!(high >= low).all() || (high - low)[2] <= (high - low)[least]) least = 2;
  return {least == 0 ? 1 : 0, least == 2 ? 1 : 2};
}

class DataWriter {
 public:
  explicit DataWriter(const RunResult& result) : result_(result) {
    for (const RobotResult& robot : result.robots) {
      number_[robot.name] = static_cast<int>(robots_.size());
      robots_.push_back(Draw(robot));
    }
    axes_ = TopViewAxes(robots_);
  }

  json Write() const {
    static constexpr const char* kAxisNames[] = {"x", "y", "z"};
    json data = {{"live", result_.live},
                 {"axes", {kAxisNames[axes_.first], kAxisNames[axes_.second]}},
                 {"levels", kHeatLevels},
                 {"robots", json::array()},
                 {"closures", Closures()}};
    for (size_t i = 0; i < robots_.size(); ++i) data["robots"].push_back(Robot(i));
    return data;
  }

 private:
  int Share(int total) const {
    return std::max(total / static_cast<int>(std::max<size_t>(1, robots_.size())), 20);
  }

  void AppendPoint(const Eigen::Vector3d& position, json& flat) const {
    const bool finite = position.allFinite();
    flat.push_back(finite ? Rounded(position[axes_.first], 100) : json(nullptr));
    flat.push_back(finite ? Rounded(position[axes_.second], 100) : json(nullptr));
  }

  json Line(const Positions& positions, const std::vector<int>& kept) const {
    json flat = json::array();
    for (int i : kept) AppendPoint(positions[i], flat);
    return flat;
  }

  json Robot(size_t number) const {
    const RobotResult& robot = result_.robots[number];
    const DrawnRobot& drawn = robots_[number];
    const std::vector<int> kept = EvenlySpread(drawn.time_s.size(), Share(kMaxPoints));
    json time_s = json::array();
    for (int i : kept) time_s.push_back(Rounded(drawn.time_s[i], 10));
    return {{"name", robot.name},
            {"drawnWithTeam", DrawnWithTeam(number)},
            {"keyframes", kept},
            {"time", time_s},
            {"paths",
             {{"truth", Line(drawn.truth, kept)},
              {"onboard", Line(drawn.onboard, kept)},
              {"server", Line(drawn.server, kept)},
              {"corrected", Line(drawn.corrected, kept)}}},
            {"errors", Errors(robot, drawn)},
            {"running", Running(robot)},
            {"constraintCount", robot.active_constraints.size()},
            {"constraints", Constraints(robot, drawn)},
            {"pathLength", drawn.path_m.empty() ? json(0) : Rounded(drawn.path_m.back(), 100)},
            {"heat", Heat(robot, drawn)}};
  }

  // Position error of each estimate at the keyframes with ground truth.
  json Errors(const RobotResult& robot, const DrawnRobot& drawn) const {
    std::vector<int> with_truth;
    for (size_t i = 0; i < drawn.truth.size(); ++i) {
      if (i < robot.ground_truth.size() && robot.ground_truth[i]) {
        with_truth.push_back(static_cast<int>(i));
      }
    }
    const std::vector<int> kept = EvenlySpread(with_truth.size(), Share(kMaxPoints));
    json errors = {{"time", json::array()}};
    for (int k : kept) errors["time"].push_back(Rounded(drawn.time_s[with_truth[k]], 10));
    const std::pair<const char*, const std::optional<TrajectoryError>*> estimates[] = {
        {"onboard", &robot.onboard_error},
        {"server", &robot.server_error},
        {"corrected", &robot.corrected_error}};
    for (const auto& [name, error] : estimates) {
      if (!*error || (*error)->per_pose_m.size() != with_truth.size()) continue;
      errors[name] = json::array();
      for (int k : kept) errors[name].push_back(Rounded((*error)->per_pose_m[k], 1000));
    }
    return errors;
  }

  // RMSE of the keyframes so far, after each comparison.
  json Running(const RobotResult& robot) const {
    json time_s = json::array(), onboard = json::array(), corrected = json::array();
    for (int i : EvenlySpread(robot.comparisons.size(), Share(kMaxPoints))) {
      const ComparisonRecord& record = robot.comparisons[i];
      if (!record.onboard_rmse_m && !record.corrected_rmse_m) continue;
      time_s.push_back(Rounded(record.time_s, 10));
      onboard.push_back(Rounded(record.onboard_rmse_m.value_or(kNan), 1000));
      corrected.push_back(Rounded(record.corrected_rmse_m.value_or(kNan), 1000));
    }
    return {{"time", time_s}, {"onboard", onboard}, {"corrected", corrected}};
  }

  // What a live map cannot tie to the others has a frame of its own.
  bool DrawnWithTeam(size_t number) const {
    return !result_.live || result_.robots[number].anchored;
  }

  // The best estimate there is.
  const Positions& Best(const DrawnRobot& drawn) const {
    return result_.live ? drawn.server : drawn.corrected;
  }

  // Each as [kind, from, to, score, x, y, x, y], on the best trajectory.
  json Constraints(const RobotResult& robot, const DrawnRobot& drawn) const {
    json rows = json::array();
    const Positions& positions = Best(drawn);
    const int64_t count = static_cast<int64_t>(positions.size());
    for (int i : EvenlySpread(robot.active_constraints.size(), Share(kMaxConstraints))) {
      const Constraint& constraint = robot.active_constraints[i];
      if (constraint.from < 0 || constraint.to < 0 || constraint.from >= count ||
          constraint.to >= count) {
        continue;
      }
      json row = {std::string(ToString(constraint.kind)), constraint.from, constraint.to,
                  Rounded(constraint.score, 1000)};
      AppendPoint(positions[constraint.from], row);
      AppendPoint(positions[constraint.to], row);
      rows.push_back(std::move(row));
    }
    return rows;
  }

  json Heat(const RobotResult& robot, const DrawnRobot& drawn) const {
    const HeatMap map =
        MakeHeatMap(robot.comparisons, drawn.path_m, std::min(60, Share(kMaxHeatRows)),
                    std::min(200, Share(kMaxHeatColumns)));
    json times = json::array();
    for (double time_s : map.row_time) times.push_back(Rounded(time_s, 10));
    return {{"columns", map.columns},
            {"max", Rounded(map.max, 1e4)},
            {"time", times},
            {"cells", map.cells}};
  }

  // The position of a node, if it is one of this run and drawn.
  std::optional<Eigen::Vector3d> Find(const NodeId& node) const {
    const auto robot = number_.find(node.mission.robot);
    if (robot == number_.end() || !DrawnWithTeam(robot->second)) return std::nullopt;
    const Positions& positions = Best(robots_[robot->second]);
    if (node.index < 0 || node.index >= static_cast<int64_t>(positions.size())) {
      return std::nullopt;
    }
    return positions[node.index];
  }

  // Each as [verdict, wrong on purpose, from, to, x, y, x, y].
  json Closures() const {
    json rows = json::array();
    for (int i : EvenlySpread(result_.closures.size(), kMaxClosures)) {
      const ClosureResult& closure = result_.closures[i];
      const auto from = Find(closure.closure.from);
      const auto to = Find(closure.closure.to);
      if (!from || !to) continue;
      json row = {closure.verdict, closure.outlier, NodeText(closure.closure.from),
                  NodeText(closure.closure.to)};
      AppendPoint(*from, row);
      AppendPoint(*to, row);
      rows.push_back(std::move(row));
    }
    return rows;
  }

  static std::string NodeText(const NodeId& node) {
    return node.mission.robot + ":" + std::to_string(node.index);
  }

  const RunResult& result_;
  std::map<std::string, int> number_;
  std::vector<DrawnRobot> robots_;
  std::pair<int, int> axes_;
};

}  // namespace

std::string ReportData(const RunResult& result) {
  // Bytes that are not UTF-8 become replacement characters; "<" must not end the script element.
  const std::string text = DataWriter(result).Write().dump(-1, ' ', /*ensure_ascii=*/true,
                                                           json::error_handler_t::replace);
  return absl::StrReplaceAll(text, {{"<", "\\u003c"}});
}

}  // namespace overtone
