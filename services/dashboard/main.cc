// SPDX-License-Identifier: Apache-2.0
// The binary: flags, each also from the environment, and the signals that end it.
#include <csignal>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <system_error>

#include "CLI/CLI.hpp"
#include "overtone/core/common/status_macros.h"
#include "overtone/services/dashboard/dashboard_server.h"

namespace overtone {
namespace {

// Blocked before any thread starts, so that only Wait() ever takes them.
class TerminationSignals {
 public:
  TerminationSignals() {
    sigemptyset(&signals_);
    sigaddset(&signals_, SIGINT);
    sigaddset(&signals_, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &signals_, nullptr);
  }

  void Wait() const {
    int signal = 0;
    sigwait(&signals_, &signal);
  }

 private:
  sigset_t signals_;
};

// Where the page is when --web-root does not say so: installed next to the binary, or in the tree
// that it was built in.
std::string FindWebRoot() {
  std::error_code error;
  const auto binary = std::filesystem::read_symlink("/proc/self/exe", error);
  if (error) return "";
  for (const std::filesystem::path& root :
       {binary.parent_path() / ".." / OVERTONE_WEB_ROOT_FROM_BIN,
        binary.parent_path() / "web" / "dist"}) {
    if (std::filesystem::exists(root / "index.html", error)) {
      return root.lexically_normal().string();
    }
  }
  return "";
}

void DeclareServer(CLI::App& app, DashboardOptions& options) {
  ServerConnection& connection = options.connection;
  app.add_option("--server", connection.server, "host:port of the mapping server")
      ->envname("OVERTONE_DASHBOARD_SERVER")
      ->capture_default_str();
  app.add_option("--map", options.map, "The map to show")
      ->envname("OVERTONE_DASHBOARD_MAP")
      ->capture_default_str();
  app.add_option("--timeout", options.timeout_s, "Seconds to wait for one answer of the server")
      ->capture_default_str();
  const std::string group = "Transport security";
  app.add_option("--tls-ca", connection.files.ca_file,
                 "PEM file of the CA that the server must be signed by")
      ->envname("OVERTONE_TLS_CA")
      ->group(group);
  app.add_option("--tls-cert", connection.files.certificate_file,
                 "PEM file of our certificate, an operator's")
      ->envname("OVERTONE_TLS_CERT")
      ->group(group);
  app.add_option("--tls-key", connection.files.key_file, "PEM file of its key")
      ->envname("OVERTONE_TLS_KEY")
      ->group(group);
  app.add_option("--tls-server-name", connection.server_name,
                 "The name in the server's certificate, when --server has another")
      ->envname("OVERTONE_TLS_SERVER_NAME")
      ->group(group);
  app.add_flag("--insecure", connection.insecure, "Talk to another host without certificates")
      ->envname("OVERTONE_INSECURE")
      ->group(group);
}

void DeclarePage(CLI::App& app, DashboardOptions& options) {
  app.add_option("--listen", options.listen, "host:port of the page; port 0 takes a free one")
      ->envname("OVERTONE_DASHBOARD_LISTEN")
      ->capture_default_str();
  app.add_option("--allowed-host", options.allowed_hosts,
                 "A name under which browsers reach the page, beside localhost and IP addresses")
      ->envname("OVERTONE_DASHBOARD_ALLOWED_HOST");
  app.add_flag("--read-only", options.read_only, "Nobody vetoes from the page")
      ->envname("OVERTONE_DASHBOARD_READ_ONLY");
  app.add_flag("--trust-network", options.trust_network,
               "Let whoever reaches the page from other hosts veto")
      ->envname("OVERTONE_DASHBOARD_TRUST_NETWORK");
  app.add_option("--web-root", options.web_root, "The built page; default: next to the binary");
}

void DeclareSize(CLI::App& app, DashboardOptions& options) {
  app.add_option_function<double>(
         "--interval",
         [&options](double seconds) { options.mirror.interval = absl::Seconds(seconds); },
         "Seconds between two looks at the map")
      ->default_str("1");
  app.add_option("--max-nodes", options.mirror.max_nodes,
                 "Keyframes shown; a larger map is thinned evenly")
      ->capture_default_str();
  app.add_option("--history-mib", options.history_mib, "Memory for revisions of the past")
      ->capture_default_str();
  app.add_option("--cloud-points", options.cloud_points, "Points shown of all clouds together")
      ->capture_default_str();
}

absl::Status Serve(DashboardOptions options) {
  if (options.web_root.empty()) options.web_root = FindWebRoot();
  if (options.web_root.empty()) {
    std::cerr << "overtone-dashboard: the page was not built, only its API is served" << std::endl;
  }
  const TerminationSignals signals;
  ASSIGN_OR_RETURN(const std::unique_ptr<DashboardServer> server, DashboardServer::Start(options));
  // Who started us reads the port from this line.
  std::cout << "listening on " << server->url() << std::endl;
  signals.Wait();
  server->Shutdown();
  return absl::OkStatus();
}

}  // namespace
}  // namespace overtone

int main(int argc, char** argv) {
  try {
    CLI::App app("Overtone's dashboard: a page about one map of a mapping server");
    overtone::DashboardOptions options;
    app.set_version_flag("--version", OVERTONE_VERSION);
    overtone::DeclareServer(app, options);
    overtone::DeclarePage(app, options);
    overtone::DeclareSize(app, options);
    CLI11_PARSE(app, argc, argv);
    const absl::Status status = overtone::Serve(options);
    if (status.ok()) return EXIT_SUCCESS;
    std::cerr << "overtone-dashboard: " << status.message() << std::endl;
  } catch (const std::exception& error) {
    std::cerr << "overtone-dashboard: " << error.what() << std::endl;
  }
  return EXIT_FAILURE;
}
