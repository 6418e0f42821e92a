// SPDX-License-Identifier: Apache-2.0
// Time of one optimisation of the map: of everything at once, and warm, after one more submap.
// Three robots drive laps of 200 m, a keyframe each metre, a closure every fifth keyframe to the
// same place a lap earlier or to another robot's first lap. Arguments: keyframes in all; wrong
// closures in per cent.
#include <random>
#include <string>

#include "benchmark/benchmark.h"
#include "overtone/core/mapping/multi_robot_map.h"
#include "overtone/tests/core/mapping/map_test_support.h"

namespace overtone {
namespace {

constexpr int kLap = 200;
constexpr int kSubmapKeyframes = 20;

class Team {
 public:
  Team(int num_keyframes, int percent_wrong)
      : random_(1),
        percent_wrong_(percent_wrong),
        lap_(CirclePoses(kLap)),
        map_(MultiRobotMapOptions()) {
    while (total_ < num_keyframes) AddRound();
  }

  // One submap of every robot.
  void AddRound() {
    for (Robot& robot : robots_) AddSubmap(robot);
  }
  std::shared_ptr<const MapSnapshot> Optimise() { return map_.Optimise(); }

  // Verdicts against the truth.
  void Count(const MapSnapshot& snapshot, benchmark::State& state) const {
    int wrong_accepted = 0;
    int right_demoted = 0;
    for (size_t k = 0; k < snapshot.closures.size(); ++k) {
      const ClosureVerdict verdict = snapshot.closures[k].verdict;
      wrong_accepted += is_wrong_[k] && verdict == ClosureVerdict::kAccepted;
      right_demoted += !is_wrong_[k] && verdict == ClosureVerdict::kDemotedByOptimiser;
    }
    state.counters["closures"] = snapshot.closures.size();
    state.counters["wrong_accepted"] = wrong_accepted;
    state.counters["right_demoted"] = right_demoted;
  }

 private:
  struct Robot {
    std::string name;
    int64_t sequence = 0;
    std::vector<Rigid3d> odometry;
  };

  void AddSubmap(Robot& robot) {
    const int64_t first = static_cast<int64_t>(robot.odometry.size());
    std::vector<LoopClosure> closures;
    for (int k = 0; k < kSubmapKeyframes; ++k) {
      const int64_t index = first + k;
      const Rigid3d step = lap_[0].Inverse() * lap_[1] * Exp(Noise(kOdometryNoise, random_));
      robot.odometry.push_back(index == 0 ? Rigid3d() : robot.odometry.back() * step);
      if (index % 5 == 0 && index >= kLap)
        closures.push_back(Closure(robot, index, robot, index - kLap));
      if (index % 5 == 2 && &robot != &robots_[0] && index < kLap) {
        closures.push_back(Closure(robot, index, robots_[0], index));
      }
    }
    Submap submap =
        MakeSubmap(robot.sequence++, first, {robot.odometry.begin() + first, robot.odometry.end()},
                   kOdometryNoise);
    submap.loop_closures = closures;
    if (!map_.AddSubmap(Mission(robot.name), submap).ok()) std::abort();
    total_ += kSubmapKeyframes;
  }

  LoopClosure Closure(const Robot& from, int64_t i, const Robot& to, int64_t j) {
    const bool wrong = static_cast<int>(random_() % 100) < percent_wrong_;
    is_wrong_.push_back(wrong);
    const Rigid3d measured = Exp(Noise(wrong ? Covariance(10, 1) : kClosureNoise, random_));
    return MakeClosure({Mission(from.name), i}, {Mission(to.name), j}, measured, kClosureNoise);
  }

  const Matrix6d kOdometryNoise = Covariance(0.02, 0.003);
  const Matrix6d kClosureNoise = Covariance(0.03, 0.009);
  std::mt19937 random_;
  const int percent_wrong_;
  const std::vector<Rigid3d> lap_;
  MultiRobotMap map_;
  std::vector<Robot> robots_ = {{"a"}, {"b"}, {"c"}};
  std::vector<bool> is_wrong_;  // of each closure, in the order in which they are added
  int total_ = 0;
};

void BM_OptimiseAll(benchmark::State& state) {
  for (auto _ : state) {
    state.PauseTiming();
    Team team(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
    state.ResumeTiming();
    const auto snapshot = team.Optimise();
    state.PauseTiming();
    team.Count(*snapshot, state);
    state.ResumeTiming();
  }
}

void BM_OptimiseWarm(benchmark::State& state) {
  Team team(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  auto snapshot = team.Optimise();
  for (auto _ : state) {
    state.PauseTiming();
    team.AddRound();
    state.ResumeTiming();
    snapshot = team.Optimise();
  }
  team.Count(*snapshot, state);
}

BENCHMARK(BM_OptimiseAll)
    ->ArgsProduct({{1000, 10000}, {0, 10}})
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1);
BENCHMARK(BM_OptimiseWarm)
    ->ArgsProduct({{1000, 10000}, {0, 10}})
    ->Unit(benchmark::kMillisecond)
    ->Iterations(4);

}  // namespace
}  // namespace overtone

BENCHMARK_MAIN();
