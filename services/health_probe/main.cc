// SPDX-License-Identifier: Apache-2.0
// The probe of containers, which have no shell: exit code 0 where the server serves. It links
// nothing heavy, so that asking every few seconds costs next to nothing.
#include <exception>
#include <iostream>

#include "CLI/CLI.hpp"
#include "overtone/services/health_probe/health_check.h"

namespace overtone {
namespace {

struct Flags {
  HealthCheckOptions check;
  double timeout_s = 2;
};

void Declare(CLI::App& app, Flags& flags) {
  app.set_version_flag("--version", OVERTONE_VERSION);
  app.footer("Exit codes: 0 it serves, 1 it does not, 2 wrong input.");
  app.add_option("--server", flags.check.server, "host:port")->capture_default_str();
  app.add_option("--service", flags.check.service,
                 "e.g. overtone.v1.MappingService [the server as a whole]");
  app.add_option("--timeout", flags.timeout_s, "Seconds")
      ->check(CLI::Range(0.001, 3600.0))
      ->capture_default_str();
  app.add_option("--tls-ca", flags.check.tls.ca_file, "PEM file of the server's CA")
      ->envname("OVERTONE_TLS_CA");
  app.add_option("--tls-cert", flags.check.tls.certificate_file,
                 "PEM file of any certificate of that CA; it needs no rights")
      ->envname("OVERTONE_TLS_CERT");
  app.add_option("--tls-key", flags.check.tls.key_file, "PEM file of its key")
      ->envname("OVERTONE_TLS_KEY");
  app.add_option("--tls-server-name", flags.check.server_name,
                 "The name in the server's certificate, when --server has another")
      ->envname("OVERTONE_TLS_SERVER_NAME");
}

int Check(Flags flags) {
  flags.check.timeout = absl::Seconds(flags.timeout_s);
  const absl::Status status = CheckHealth(flags.check);
  if (status.ok()) return 0;
  std::cerr << "overtone-health: " << status.message() << "\n";
  return absl::IsUnavailable(status) ? 1 : 2;
}

}  // namespace
}  // namespace overtone

int main(int argc, char** argv) {
  try {
    CLI::App app("Ask a server's grpc.health.v1", "overtone-health");
    overtone::Flags flags;
    overtone::Declare(app, flags);
    try {
      app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
      return app.exit(error) == 0 ? 0 : 2;
    }
    return overtone::Check(flags);
  } catch (const std::exception& error) {
    std::cerr << "overtone-health: " << error.what() << "\n";
    return 2;
  }
}
