// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/health_command.h"

#include <iostream>
#include <memory>
#include <string>

#include "absl/strings/str_cat.h"
#include "nlohmann/json.hpp"
#include "overtone/client/cli/admin_client.h"
#include "overtone/client/cli/admin_flags.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {
namespace {

struct HealthFlags : AdminFlags {
  HealthFlags() { timeout_s = 3; }
  std::string service;
};

absl::Status CheckHealth(const HealthFlags& flags) {
  ASSIGN_OR_RETURN(const std::string health, flags.Client().Health(flags.service));
  if (flags.json) {
    std::cout << nlohmann::json{{"server", flags.server},
                                {"service", flags.service},
                                {"status", health}}
                     .dump()
              << "\n";
  } else {
    std::cout << health << "\n";
  }
  if (health == "SERVING") return absl::OkStatus();
  return absl::FailedPreconditionError(absl::StrCat("server ", flags.server, " is not serving"));
}

}  // namespace

void AddHealthCommand(CLI::App* app, std::function<int()>* run) {
  const auto flags = std::make_shared<HealthFlags>();
  CLI::App* command = AddAdminCommand(
      app, "health", "Ask whether a server serves: exit code 0 or 1",
      {/*map=*/false, /*json=*/true, /*one_failure=*/true}, flags.get(),
      [flags] { return CheckHealth(*flags); }, run);
  command->add_option(
      "--service", flags->service,
      "overtone.v1.MappingService or overtone.v1.MapAdminService [the whole server]");
  command->footer(
      "Exit code 0: it serves. 1: it does not, or cannot be reached, whatever the reason. Any "
      "certificate that\n"
      "the server knows will do. --json: {\"server\", \"service\", \"status\"}.\n\n"
      "  overtone health --server localhost:7077\n"
      "  HEALTHCHECK CMD [\"overtone\", \"health\"]      # OVERTONE_SERVER, OVERTONE_TLS_CA, ... "
      "in "
      "the environment");
}

}  // namespace overtone
