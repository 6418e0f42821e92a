// SPDX-License-Identifier: Apache-2.0
// A team that drives about the streets of a chequered town, each street four times on average: a
// keyframe each metre, submaps of 20, and at every fifth keyframe a closure to whoever was at that
// place last. Seeded.
#ifndef OVERTONE_TESTS_SUPPORT_STREET_TEAM_H_
#define OVERTONE_TESTS_SUPPORT_STREET_TEAM_H_

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "overtone/core/mapping/multi_robot_map.h"
#include "overtone/tests/core/mapping/map_test_support.h"

namespace overtone {

class StreetTeam {
 public:
  // For a town in which `keyframes` metres are driven.
  StreetTeam(int num_robots, int64_t keyframes)
      : blocks_(std::max(2, static_cast<int>(std::sqrt(static_cast<double>(keyframes) / kVisits /
                                                       (2 * kBlockM))))) {
    for (int r = 0; r < num_robots; ++r) {
      Robot& robot = robots_.emplace_back();
      robot.name = "r" + std::to_string(r);
      robot.x = RandomCrossing();
      robot.y = RandomCrossing();
    }
  }

  int64_t NumKeyframes() const { return num_keyframes_; }

  // Of a robot, in turn.
  void AddSubmap(MultiRobotMap& map) {
    Prepare();
    AddPrepared(map);
  }
  // The same in two steps: the first is not the map's work.
  void Prepare() {
    Robot& robot = robots_[next_robot_++ % robots_.size()];
    const int64_t first = robot.next_index;
    std::vector<Rigid3d> odometry;
    std::vector<LoopClosure> closures;
    for (int k = 0; k < kSubmapKeyframes; ++k) {
      Drive(robot);
      odometry.push_back(robot.odometry);
      if (const int64_t index = robot.next_index++; index % kClosureEvery == 0) {
        LookAround(robot, index, closures);
      }
    }
    prepared_ = MakeSubmap(robot.next_sequence++, first, odometry, motion_covariance_);
    prepared_.loop_closures = std::move(closures);
    prepared_of_ = Mission(robot.name);
    num_keyframes_ += kSubmapKeyframes;
  }
  void AddPrepared(MultiRobotMap& map) {
    if (!map.AddSubmap(prepared_of_, prepared_).ok()) std::abort();
  }

  // Its own memory, roughly: what it remembers of places.
  double HeapBytes() const { return static_cast<double>(last_at_.size()) * kBytesOfPlace; }

 private:
  static constexpr int kSubmapKeyframes = 20;
  static constexpr int kClosureEvery = 5;
  static constexpr int kBlockM = 50;
  static constexpr double kVisits = 4;
  static constexpr double kBytesOfPlace = 144;

  struct Robot {
    std::string name;
    int x = 0, y = 0;
    int dx = 1, dy = 0;
    Rigid3d truth;
    Rigid3d odometry;
    int64_t next_index = 0;
    int64_t next_sequence = 0;
  };
  struct Visit {
    int robot = 0;
    int64_t index = 0;
    Rigid3d truth;
  };

  int RandomCrossing() { return kBlockM * static_cast<int>(random_() % (blocks_ + 1)); }

  // One metre along the street; a turn at every crossing, back at the end of the town.
  void Drive(Robot& robot) {
    if (robot.x % kBlockM == 0 && robot.y % kBlockM == 0) Turn(robot);
    const Rigid3d from = robot.truth;
    robot.x += robot.dx;
    robot.y += robot.dy;
    robot.truth = Planar(robot.x, robot.y, std::atan2(robot.dy, robot.dx));
    if (robot.next_index == 0) return;  // odometry begins where the mission does
    robot.odometry =
        robot.odometry * (from.Inverse() * robot.truth) * Exp(Noise(motion_covariance_, random_));
  }

  void Turn(Robot& robot) {
    do {
      if (random_() % 2 == 0) {
        std::swap(robot.dx, robot.dy);
        if (random_() % 2 == 0) {
          robot.dx = -robot.dx;
          robot.dy = -robot.dy;
        }
      }
      if (!Inside(robot.x + robot.dx) || !Inside(robot.y + robot.dy)) {
        robot.dx = -robot.dx;
        robot.dy = -robot.dy;
      }
    } while (!Inside(robot.x + robot.dx) || !Inside(robot.y + robot.dy));
  }
  bool Inside(int along) const { return along >= 0 && along <= blocks_ * kBlockM; }

  void LookAround(const Robot& robot, int64_t index, std::vector<LoopClosure>& closures) {
    const int number = static_cast<int>(&robot - robots_.data());
    // Whole cells of five metres: keyframes of two robots seldom fall on the same metre.
    const auto [place, fresh] =
        last_at_.insert({{robot.x / kClosureEvery, robot.y / kClosureEvery}, {}});
    const Visit& last = place->second;
    if (!fresh && (last.robot != number || index - last.index > 2 * kClosureEvery)) {
      const Rigid3d measured =
          robot.truth.Inverse() * last.truth * Exp(Noise(closure_covariance_, random_));
      closures.push_back(MakeClosure({Mission(robot.name), index},
                                     {Mission(robots_[last.robot].name), last.index}, measured,
                                     closure_covariance_));
    }
    place->second = {number, index, robot.truth};
  }

  const Matrix6d motion_covariance_ = Covariance(0.02, 0.003);
  const Matrix6d closure_covariance_ = Covariance(0.03, 0.009);
  const int blocks_;
  std::mt19937 random_{1};
  std::vector<Robot> robots_;
  size_t next_robot_ = 0;
  int64_t num_keyframes_ = 0;
  std::map<std::pair<int, int>, Visit> last_at_;
  Submap prepared_;
  MissionId prepared_of_;
};

}  // namespace overtone

#endif  // OVERTONE_TESTS_SUPPORT_STREET_TEAM_H_
