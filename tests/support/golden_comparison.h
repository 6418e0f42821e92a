// SPDX-License-Identifier: Apache-2.0
// The golden cases as a server's graph and a robot's trajectory.
#ifndef OVERTONE_TESTS_SUPPORT_GOLDEN_COMPARISON_H_
#define OVERTONE_TESTS_SUPPORT_GOLDEN_COMPARISON_H_

#include <string>
#include <vector>

#include "overtone/core/graph/map_graph.h"
#include "overtone/core/synchronization/constraint_generation.h"
#include "overtone/core/synchronization/node_association.h"
#include "overtone/core/synchronization/synchronization_options.h"
#include "overtone/tests/support/golden_case.h"

namespace overtone::golden {

// All nodes as one mission, as the prototype saw them.
inline MapGraph Graph(const std::vector<Pose>& server) {
  MapMission mission;
  mission.id = {"robot", "mission"};
  for (int i = 0; i < server.size(); ++i) {
    const bool start = i == 0 || server[i].submap_id != server[i - 1].submap_id;
    mission.nodes.push_back({i, server[i].stamp, server[i].map_from_body, start, false});
  }
  MapGraph graph;
  graph.revision = 1;
  graph.missions = {mission};
  return graph;
}

inline std::vector<NodePose> Trajectory(const std::vector<Pose>& robot) {
  std::vector<NodePose> trajectory;
  for (int i = 0; i < robot.size(); ++i) {
    trajectory.push_back({i, robot[i].stamp, robot[i].map_from_body});
  }
  return trajectory;
}

inline SynchronizationOptions PrototypeOptions(const Case& c, int num_scales) {
  SynchronizationOptions options;
  options.graph = c.graph_options();
  options.signal_weights = PrototypeSignalWeights();
  options.wavelets.num_scales = num_scales;
  options.wavelets.method = FilterMethod::kExact;
  return options;
}

// The prototype's configuration beside the vectors, in our terms.
inline ConstraintOptions PrototypeConstraintOptions(const nlohmann::json& config) {
  ConstraintOptions options;
  options.mid_hops = config.at("n_hop_mid_constraints").get<int>();
  options.large_min_distance_m = config.at("min_dist_large_constraints").get<double>();
  options.large_min_path_m = config.at("min_dist_along_graph_large_constraints").get<double>();
  options.large_max_distance_m = config.at("max_lookup_dist_large_constraints").get<double>();
  options.large_neighbors = config.at("nn_neighbors").get<int>();
  return options;
}

// [[node, [label, ...]], ...], label = column of the table + 1; ours: small band first.
inline std::vector<DiscrepancyLabel> Labels(const nlohmann::json& labels) {
  std::vector<DiscrepancyLabel> result;
  for (const auto& node : labels) {
    for (int band = 2; band >= 0; --band) {
      for (const auto& label : node.at(1)) {
        if (label.get<int>() != band + 1) continue;
        result.push_back({node.at(0).get<int>(), static_cast<Band>(band), 0});
      }
    }
  }
  return result;
}

struct ConstraintRow {
  int parent = 0;
  int child = 0;
  std::string type;  // "SMALL", "MID", "LARGE"
  Rigid3d parent_from_child;
};

inline std::vector<ConstraintRow> ReadConstraints(const std::filesystem::path& path) {
  const Table table(path);
  std::vector<ConstraintRow> rows;
  for (int i = 0; i < table.num_rows(); ++i) {
    const auto at = [&](const char* column) { return table.Number(i, column); };
    const Rigid3d transform(Eigen::Quaterniond(at("qw"), at("qx"), at("qy"), at("qz")),
                            Eigen::Vector3d(at("tx"), at("ty"), at("tz")));
    rows.push_back(
        {table.Integer(i, "parent"), table.Integer(i, "child"), table.Cell(i, "type"), transform});
  }
  return rows;
}

}  // namespace overtone::golden

#endif  // OVERTONE_TESTS_SUPPORT_GOLDEN_COMPARISON_H_
