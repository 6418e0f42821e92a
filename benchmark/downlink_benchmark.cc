// SPDX-License-Identifier: Apache-2.0
// Bytes a second that one robot is sent while a team drives at a metre a second, each robot closes
// a submap every 20 s, and the map is optimised and published again after so many `submaps` of all
// robots: COMPACT, nodes a metre apart, deltas from revision to revision. Keyframes above
// `nodes` are Kron-reduced. `own`: the robot asks for its own nodes alone. The time is that of
// building and serialising one revision. The map grows from `keyframes` on, and so beyond `nodes`.
#include <chrono>
#include <cstdint>
#include <memory>

#include "benchmark/benchmark.h"
#include "overtone/services/mapping_server/graph_frames.h"
#include "overtone/tests/support/street_team.h"

namespace overtone {
namespace {

constexpr double kSubmapS = 20;  // of StreetTeam's 20 m
constexpr int kRevisions = 40;

void BM_Downlink(benchmark::State& state) {
  const int robots = static_cast<int>(state.range(0));
  const int64_t keyframes = state.range(2);
  const auto submaps = static_cast<int>(state.range(3));
  ServerOptions options;
  options.graph.max_nodes = static_cast<int>(state.range(1));
  const GraphQuery query = {options.graph.max_nodes, false, state.range(4) != 0 ? "r0" : ""};
  GraphFrames frames("town", 1, options);
  MultiRobotMap map{MultiRobotMapOptions()};
  StreetTeam team(robots, keyframes);
  while (team.NumKeyframes() < keyframes) team.AddSubmap(map);
  frames.SetSnapshot(map.Optimise());
  const auto snapshot = frames.Frame(query, v1::GRAPH_ENCODING_COMPACT, {});
  GraphPosition robot = frames.position();
  double bytes = 0;
  for (auto _ : state) {
    for (int i = 0; i < submaps; ++i) team.AddSubmap(map);
    frames.SetSnapshot(map.Optimise());
    const auto begin = std::chrono::steady_clock::now();
    const auto frame = frames.Frame(query, v1::GRAPH_ENCODING_COMPACT, robot);
    const std::chrono::duration<double> building = std::chrono::steady_clock::now() - begin;
    if (!frame.ok()) return state.SkipWithError(frame.status().ToString().c_str());
    state.SetIterationTime(building.count());
    robot = frames.position();
    bytes += static_cast<double>(frame->Length());
  }
  const double seconds = kSubmapS * submaps / robots;  // from one revision to the next
  state.counters["revisions_per_s"] = 1 / seconds;
  state.counters["snapshot_bytes"] = static_cast<double>(snapshot->Length());
  state.counters["delta_bytes"] = bytes / static_cast<double>(state.iterations());
  state.counters["bytes_per_s"] = bytes / static_cast<double>(state.iterations()) / seconds;
}
BENCHMARK(BM_Downlink)
    ->ArgNames({"robots", "nodes", "keyframes", "submaps", "own"})
    ->Args({10, 2000, 1600, 10, 0})
    ->Args({10, 2000, 1600, 1, 0})
    ->Args({3, 2000, 1600, 1, 0})
    ->Args({10, 2000, 16000, 1, 1})
    ->UseManualTime()
    ->Iterations(kRevisions)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace overtone
