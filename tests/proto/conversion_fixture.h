// SPDX-License-Identifier: Apache-2.0
// Small valid messages and graphs that the tests of this folder and of the services start from.
#ifndef OVERTONE_TESTS_PROTO_CONVERSION_FIXTURE_H_
#define OVERTONE_TESTS_PROTO_CONVERSION_FIXTURE_H_

#include <cstdint>
#include <random>
#include <string>

#include "overtone/core/graph/map_graph.h"
#include "overtone/core/graph/submap.h"

namespace overtone::testing {

constexpr int64_t kStampStepNs = 200'000'000;

inline Rigid3d RandomPose(std::mt19937& random, double extent_m) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const Eigen::Vector3d axis(uniform(random), uniform(random), uniform(random));
  const Eigen::Vector3d position(uniform(random), uniform(random), uniform(random));
  return Rigid3d(ExpSO3(axis.normalized() * 3.14159 * uniform(random)), extent_m * position);
}

// A covariance with correlations between all six elements.
inline Matrix6d FullCovariance() {
  Matrix6d root = Matrix6d::Zero();
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column <= row; ++column) {
      root(row, column) = 0.01 * (row == column ? 3.0 : 0.3 * (column - row));
    }
  }
  return root * root.transpose();
}

// Keyframes of a gentle curve, 0.5 m apart, index and stamp counted from `first_index`.
inline Submap MakeSubmap(int64_t sequence, int64_t first_index, int num_keyframes) {
  Submap submap;
  submap.sequence = sequence;
  submap.first_index = first_index;
  for (int i = 0; i < num_keyframes; ++i) {
    const double index = static_cast<double>(first_index + i);
    Keyframe keyframe;
    keyframe.stamp = {1'000'000'000 + (first_index + i) * kStampStepNs};
    keyframe.mission_from_body = Rigid3d(
        ExpSO3(Eigen::Vector3d(0, 0, 0.02 * index)),
        Eigen::Vector3d(25.0 * std::sin(0.02 * index), 25.0 * (1 - std::cos(0.02 * index)), 0));
    keyframe.motion_covariance = FullCovariance();
    submap.keyframes.push_back(keyframe);
  }
  return submap;
}

inline LoopClosure MakeClosure(const NodeId& from, const NodeId& to) {
  LoopClosure closure;
  closure.from = from;
  closure.to = to;
  closure.from_tform_to =
      Rigid3d(ExpSO3(Eigen::Vector3d(0.1, -0.2, 0.3)), Eigen::Vector3d(1, 2, 3));
  closure.covariance = FullCovariance();
  return closure;
}

// A submap of five keyframes or more with one of everything that may lie beside keyframes and
// closures.
inline void AddOneOfEach(const MissionId& mission, Submap& submap) {
  const int64_t index = submap.first_index + 2;
  submap.keyframes[3].degenerate = true;
  submap.keyframes[3].degenerate_direction = Eigen::Vector3d(0.6, 0, 0.8);
  submap.candidates.push_back({{mission, index}, {{"bert", "x"}, 400}, 0.75});
  submap.clouds.push_back({index, nullptr, std::string(32, 'c'), 1234});
  Eigen::Matrix3d covariance = 0.01 * Eigen::Matrix3d::Identity();
  covariance(0, 2) = covariance(2, 0) = 0.004;
  submap.landmark_sightings.push_back({index, "tag_7", {1, 2, 3}, covariance});
  submap.robot_sightings.push_back({index, "bert", {4, 5, 6}, covariance});
  submap.absolute_poses.push_back(
      {index, Rigid3d(ExpSO3(Eigen::Vector3d(0.1, 0, 0)), {7, 8, 9}), FullCovariance()});
}

// `num_missions` walks of `nodes_per_mission` nodes, about 0.4 m and 0.1 rad from node to node.
inline MapGraph MakeGraph(std::mt19937& random, int num_missions, int nodes_per_mission) {
  std::normal_distribution<double> normal;
  MapGraph graph;
  graph.revision = 7;
  graph.map_epoch = 1;
  for (int m = 0; m < num_missions; ++m) {
    MapMission mission;
    mission.id = {"robot" + std::to_string(m), "run"};
    mission.anchored = m == 0;
    mission.component = m;
    mission.map_from_mission = RandomPose(random, 10.0);
    Rigid3d pose = RandomPose(random, 10.0);
    for (int i = 0; i < nodes_per_mission; ++i) {
      Vector6d step;
      step << 0.4 + 0.1 * normal(random), 0.05 * normal(random), 0.05 * normal(random),
          0.05 * normal(random), 0.05 * normal(random), 0.1 * normal(random);
      pose = pose * Exp(step);
      MapNode node;
      node.index = 2 * i + 1;
      node.stamp = {1'403'636'580'838'555'648 + i * kStampStepNs};
      node.map_from_body = pose;
      node.submap_start = i % 10 == 0;
      node.degenerate = i % 17 == 3;
      mission.nodes.push_back(node);
    }
    graph.missions.push_back(mission);
  }
  const int num_nodes = graph.NumNodes();
  for (int i = 0; i + 3 < num_nodes; ++i)
    graph.edges.push_back({i, i + 1 + i % 3, 0.1 + 0.001 * i});
  return graph;
}

inline bool operator==(const Rigid3d& a, const Rigid3d& b) {
  return a.translation == b.translation && a.rotation.coeffs() == b.rotation.coeffs();
}

// Bit by bit.
inline bool SameNodes(const MapMission& a, const MapMission& b) {
  if (a.nodes.size() != b.nodes.size()) return false;
  for (size_t i = 0; i < a.nodes.size(); ++i) {
    const MapNode& x = a.nodes[i];
    const MapNode& y = b.nodes[i];
    if (x.index != y.index || x.stamp != y.stamp || x.submap_start != y.submap_start ||
        x.degenerate != y.degenerate || !(x.map_from_body == y.map_from_body)) {
      return false;
    }
  }
  return true;
}

// Bit by bit, revisions included.
inline bool SameGraph(const MapGraph& a, const MapGraph& b) {
  if (a.revision != b.revision || a.map_epoch != b.map_epoch ||
      a.missions.size() != b.missions.size() || a.edges.size() != b.edges.size()) {
    return false;
  }
  for (size_t i = 0; i < a.missions.size(); ++i) {
    const MapMission& x = a.missions[i];
    const MapMission& y = b.missions[i];
    if (x.id != y.id || x.anchored != y.anchored || x.component != y.component ||
        !(x.map_from_mission == y.map_from_mission) || !SameNodes(x, y)) {
      return false;
    }
  }
  for (size_t i = 0; i < a.edges.size(); ++i) {
    if (a.edges[i].first != b.edges[i].first || a.edges[i].second != b.edges[i].second ||
        a.edges[i].weight != b.edges[i].weight) {
      return false;
    }
  }
  return true;
}

}  // namespace overtone::testing

#endif  // OVERTONE_TESTS_PROTO_CONVERSION_FIXTURE_H_
