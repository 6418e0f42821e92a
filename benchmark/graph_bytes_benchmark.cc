// SPDX-License-Identifier: Apache-2.0
// Bytes of one revision on the wire: PLAIN and COMPACT, whole and as the difference to the revision
// before, beside the 8 N^2 of a dense matrix of doubles. Three robots, keyframes 0.4 m and 0.1 rad
// apart. From one revision to the next a tenth of each trajectory's nodes is new, and the rest
// bends by a smooth correction that reaches `move_m`.
#include <cmath>
#include <cstdio>
#include <random>

#include "overtone/proto/conversion/graph_conversion.h"
#include "overtone/proto/conversion/published_graph.h"

namespace overtone {
namespace {

constexpr int kMissions = 3;

MapGraph Walk(int num_nodes) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  MapGraph graph;
  graph.revision = 1;
  graph.map_epoch = 1;
  for (int m = 0; m < kMissions; ++m) {
    MapMission mission;
    mission.id = {"robot" + std::to_string(m), "run"};
    Rigid3d pose;
    for (int i = 0; i < num_nodes / kMissions; ++i) {
      Vector6d step;
      step << 0.4, 0.02 * normal(random), 0.02 * normal(random), 0.02 * normal(random),
          0.02 * normal(random), 0.1 * normal(random);
      pose = pose * Exp(step);
      MapNode node;
      node.index = 2 * i;
      node.stamp = {1'403'636'580'838'555'648 + i * 400'123'456};
      node.map_from_body = pose;
      mission.nodes.push_back(node);
    }
    graph.missions.push_back(mission);
  }
  return graph;
}

// Without the newest tenth, and before the correction.
MapGraph Before(const MapGraph& graph, double move_m) {
  MapGraph before = graph;
  ++before.revision;
  for (MapMission& mission : before.missions) {
    mission.nodes.resize(mission.nodes.size() * 9 / 10);
    for (size_t i = 0; i < mission.nodes.size(); ++i) {
      const double along = static_cast<double>(i) / static_cast<double>(mission.nodes.size());
      mission.nodes[i].map_from_body.translation.x() += move_m * along * along;
    }
  }
  return before;
}

size_t Bytes(const google::protobuf::MessageLite& message) { return message.ByteSizeLong(); }

void PrintRow(int num_nodes, double move_m) {
  MapGraph exact = Walk(num_nodes);
  exact.revision = 3;
  const PublicationTolerance tolerance;
  const ColumnUnits units;
  const MapGraph base = PublishedGraph(Before(exact, move_m), MapGraph(), tolerance, units);
  const MapGraph target = PublishedGraph(exact, base, tolerance, units);
  GraphFormat plain;
  plain.map = "map";
  plain.encoding = v1::GRAPH_ENCODING_PLAIN;
  GraphFormat compact = plain;
  compact.encoding = v1::GRAPH_ENCODING_COMPACT;
  std::printf("%6d %8.3f %10zu %10zu %10zu %10zu %12.0f\n", target.NumNodes(), move_m,
              Bytes(ToProto(target, plain)), Bytes(MakeDelta(base, target, plain)),
              Bytes(ToProto(target, compact)), Bytes(MakeDelta(base, target, compact)),
              8.0 * num_nodes * num_nodes);
}

}  // namespace
}  // namespace overtone

int main() {
  std::printf("%6s %8s %10s %10s %10s %10s %12s\n", "nodes", "moved m", "PLAIN", "delta", "COMPACT",
              "delta", "8 N^2");
  for (const int num_nodes : {200, 1000, 2000, 3000}) {
    for (const double move_m : {0.0, 0.01, 0.1}) overtone::PrintRow(num_nodes, move_m);
  }
}
