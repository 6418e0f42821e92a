// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/client_flags.h"

#include <map>

#include "absl/strings/str_cat.h"

namespace overtone {
namespace {

const std::map<std::string, SelectionStrategy>& Strategies() {
  static const auto* const names = new std::map<std::string, SelectionStrategy>{
      {"none", SelectionStrategy::kNone},
      {"top_n", SelectionStrategy::kTopN},
      {"threshold", SelectionStrategy::kThreshold},
      {"uniform", SelectionStrategy::kUniform},
      {"random", SelectionStrategy::kRandom},
      {"largest_edge_error", SelectionStrategy::kLargestEdgeError},
      {"all", SelectionStrategy::kAll},
      {"knots", SelectionStrategy::kKnots}};
  return *names;
}

const std::map<std::string, DistanceMetric>& Metrics() {
  static const auto* const names =
      new std::map<std::string, DistanceMetric>{{"se3", DistanceMetric::kSe3},
                                                {"r3", DistanceMetric::kR3},
                                                {"so3", DistanceMetric::kSo3},
                                                {"so3_trace", DistanceMetric::kSo3Trace}};
  return *names;
}

template <typename Value>
CLI::IsMember OneOf(const std::map<std::string, Value>& names) {
  std::vector<std::string> keys;
  for (const auto& [name, value] : names) keys.push_back(name);
  return CLI::IsMember(keys);
}

std::string Number(double value) { return absl::StrCat(value); }

}  // namespace

void AddClientFlags(CLI::App* app, ClientFlags* flags) {
  const std::string group = "Comparison and constraints";
  app->add_option("--strategy", flags->strategy, "Which constraints to pick")
      ->check(OneOf(Strategies()))
      ->capture_default_str()
      ->group(group);
  app->add_option(
         "--n", flags->n,
         "knots: constraints in force, at most; else how many the strategy picks per comparison")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str()
      ->group(group);
  app->add_option("--tolerance", flags->tolerance_m,
                  "knots: stop when the predicted RMSE to the server's estimate is below, metres")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str()
      ->group(group);
  app->add_option("--min-discrepancy", flags->min_discrepancy,
                  "Floor of top_n, threshold of threshold; units of the signal: about metres, with "
                  "so3 radians (there 0.005 does)")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str()
      ->group(group);
  app->add_option("--metric", flags->metric, "Distance between poses, in edges and signal")
      ->check(OneOf(Metrics()))
      ->capture_default_str()
      ->group(group);
  app->add_option("--scales", flags->scales, "Wavelet scales")
      ->check(CLI::Range(3, 9))
      ->capture_default_str()
      ->group(group);
  app->add_option("--signal", flags->signal, "What is compared at each node")
      ->check(CLI::IsMember({"distance", "se3_log"}))
      ->capture_default_str()
      ->group(group);
  app->add_option("--signal-weights", flags->signal_weights, "Rotation against translation")
      ->check(CLI::IsMember({"isotropic", "prototype"}))
      ->capture_default_str()
      ->group(group);
  app->add_flag("--multi-robot-graph", flags->multi_robot_graph,
                "Build the wavelets on the graph of all robots instead of the robot's own");
  app->add_option("--max-nodes", flags->max_nodes,
                  "Nodes the server may send a robot, 0: the server's limit")
      ->check(CLI::Range(0, 1000000))
      ->capture_default_str()
      ->group(group);
  app->add_option("--encoding", flags->encoding, "Of graphs on the wire")
      ->check(CLI::IsMember({"compact", "plain"}))
      ->capture_default_str()
      ->group(group);
  app->add_option("--outbox", flags->outbox,
                  "Directory in which what the server has not acknowledged survives the robot's "
                  "process; none: in memory");
  app->add_option("--seed", flags->seed, "Of everything random")->capture_default_str();
}

void ClientFlags::ApplyTo(MappingClientOptions* options) const {
  SynchronizationOptions& synchronization = options->synchronization;
  synchronization.selection.strategy = Strategies().at(strategy);
  synchronization.selection.n = n;
  synchronization.selection.tolerance_m = tolerance_m;
  synchronization.selection.min_discrepancy = min_discrepancy;
  synchronization.selection.seed = seed;
  synchronization.graph.metric = Metrics().at(metric);
  synchronization.wavelets.num_scales = scales;
  synchronization.signal = signal == "se3_log" ? SignalKind::kSe3Log : SignalKind::kDistance;
  if (signal_weights == "prototype") synchronization.signal_weights = PrototypeSignalWeights();
  synchronization.multi_robot_graph = multi_robot_graph;
  options->whole_map = multi_robot_graph;
  options->max_nodes = max_nodes;
  options->compact = encoding == "compact";
  options->outbox_dir = outbox;
}

std::vector<std::pair<std::string, std::string>> ClientFlags::Describe() const {
  return {{"strategy", strategy},
          {"n", absl::StrCat(n)},
          {"tolerance", Number(tolerance_m)},
          {"min-discrepancy", Number(min_discrepancy)},
          {"metric", metric},
          {"scales", absl::StrCat(scales)},
          {"signal", signal},
          {"signal-weights", signal_weights},
          {"max-nodes", absl::StrCat(max_nodes)},
          {"encoding", encoding},
          {"seed", absl::StrCat(seed)}};
}

std::vector<std::string> ClientFlags::ToArguments() const {
  std::vector<std::string> arguments;
  for (const auto& [name, value] : Describe()) {
    arguments.push_back(absl::StrCat("--", name, "=", value));
  }
  if (multi_robot_graph) arguments.push_back("--multi-robot-graph");
  if (!outbox.empty()) arguments.push_back(absl::StrCat("--outbox=", outbox));
  return arguments;
}

}  // namespace overtone
