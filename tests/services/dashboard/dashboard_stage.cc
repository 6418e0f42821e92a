// SPDX-License-Identifier: Apache-2.0
// A synthetic server and a dashboard before it, for the tests of the page. Commands on stdin, one a
// line, each answered on stdout: "advance" (a revision, "ok"), "refuse" and "answer" (the server
// goes away and comes back, "ok"). Ends with stdin.
#include <cstdlib>
#include <iostream>
#include <memory>
#include <string>

#include "CLI/CLI.hpp"
#include "overtone/services/dashboard/dashboard_server.h"
#include "overtone/tests/services/dashboard/synthetic_server.h"

namespace overtone {
namespace {

void Obey(const std::string& command, testing::SyntheticServer& server) {
  if (command == "advance") {
    server.Advance();
  } else if (command == "refuse") {
    server.Refuse(grpc::StatusCode::UNAVAILABLE);
  } else if (command == "answer") {
    server.Refuse(grpc::StatusCode::OK);
  } else {
    std::cout << "unknown command" << std::endl;
    return;
  }
  std::cout << "ok" << std::endl;
}

int Run(int argc, char** argv) {
  CLI::App app("A synthetic map and its dashboard");
  testing::SyntheticMapOptions map;
  DashboardOptions options;
  options.listen = "localhost:0";
  options.mirror.interval = absl::Milliseconds(200);
  app.add_option("--robots", map.robots);
  app.add_option("--nodes", map.nodes);
  app.add_option("--web-root", options.web_root)->required();
  app.add_flag("--read-only", options.read_only);
  CLI11_PARSE(app, argc, argv);
  testing::SyntheticServer server(map);
  options.connection.server = server.address();
  const auto dashboard = DashboardServer::Start(options);
  if (!dashboard.ok()) {
    std::cerr << dashboard.status() << std::endl;
    return EXIT_FAILURE;
  }
  std::cout << "listening on " << (*dashboard)->url() << std::endl;
  std::string command;
  while (std::getline(std::cin, command)) Obey(command, server);
  return EXIT_SUCCESS;
}

}  // namespace
}  // namespace overtone

int main(int argc, char** argv) { return overtone::Run(argc, argv); }
