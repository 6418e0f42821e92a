// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_SERVICES_DASHBOARD_DASHBOARD_OPTIONS_H_
#define OVERTONE_SERVICES_DASHBOARD_DASHBOARD_OPTIONS_H_

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "overtone/services/dashboard/map_mirror.h"
#include "overtone/services/dashboard/server_channel.h"

namespace overtone {

struct ListenAddress {
  std::string host;
  int port = 0;  // 0: a free one
};

// "host:port" or "[::1]:port". InvalidArgument, naming --listen.
absl::StatusOr<ListenAddress> ParseListenAddress(const std::string& text);

struct DashboardOptions {
  ServerConnection connection;
  std::string map = "default";
  // The page has no log-in: whoever reaches it sees the map, and may veto unless read_only.
  std::string listen = "localhost:8080";
  // Names under which the page is reached, beside localhost, the host of `listen` and IP addresses.
  std::vector<std::string> allowed_hosts;
  bool read_only = false;
  // Let whoever reaches the page from other hosts veto, too.
  bool trust_network = false;
  std::string web_root;   // the built page; empty: the API alone
  double timeout_s = 10;  // of one call to the mapping server
  // Revisions kept for the time slider, and of each at most so many positions: about 400 revisions
  // of the largest maps.
  int history_mib = 64;
  int64_t history_nodes = 10'000;
  int64_t cloud_points = 500'000;  // what a browser on a laptop carries
  MirrorOptions mirror;

  // InvalidArgument, naming the flag.
  absl::Status Validate() const;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_DASHBOARD_DASHBOARD_OPTIONS_H_
