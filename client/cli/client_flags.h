// SPDX-License-Identifier: Apache-2.0
// Flags that steer a robot's client, the same for `overtone replay` and for the `overtone robot` it
// starts.
#ifndef OVERTONE_CLIENT_CLI_CLIENT_FLAGS_H_
#define OVERTONE_CLIENT_CLI_CLIENT_FLAGS_H_

#include <string>
#include <utility>
#include <vector>

#include "CLI/CLI.hpp"
#include "overtone/client/mapping_client_options.h"

namespace overtone {

struct ClientFlags {
  std::string strategy = "knots";
  std::string metric = "se3";
  std::string signal = "distance";
  std::string signal_weights = "isotropic";
  std::string encoding = "compact";
  int n = 15;
  int scales = 6;
  int max_nodes = 0;
  double tolerance_m = SelectionOptions().tolerance_m;
  double min_discrepancy = SelectionOptions().min_discrepancy;
  bool multi_robot_graph = false;
  std::string outbox;  // a directory; empty: in memory
  uint64_t seed = 1;

  // Into the client's own options. The values were checked when they were parsed.
  void ApplyTo(MappingClientOptions* options) const;

  // The flags that give these values again when parsed.
  std::vector<std::string> ToArguments() const;

  // For people.
  std::vector<std::pair<std::string, std::string>> Describe() const;
};

void AddClientFlags(CLI::App* app, ClientFlags* flags);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_CLIENT_FLAGS_H_
