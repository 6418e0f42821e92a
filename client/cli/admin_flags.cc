// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/admin_flags.h"

#include <utility>

#include "overtone/client/cli/exit_code.h"
#include "overtone/client/cli/tls_flags.h"

namespace overtone {

CLI::App* AddAdminCommand(CLI::App* app, const std::string& name, const std::string& what,
                          AdminFlagSet set, AdminFlags* flags, std::function<absl::Status()> act,
                          std::function<int()>* run) {
  CLI::App* command = app->add_subcommand(name, what);
  command->add_option("--server", flags->server, "host:port of the mapping server")
      ->capture_default_str();
  command->add_option("--timeout", flags->timeout_s, "Seconds to wait for the server")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  AddTlsFlags(command, &flags->tls);
  if (set.map) command->add_option("--map", flags->map, "Map")->capture_default_str();
  if (set.json) command->add_flag("--json", flags->json, "One JSON object per line");
  const std::string full_name = app->get_parent() == nullptr ? name : app->get_name() + " " + name;
  command->callback([full_name, run, flags, act = std::move(act)] {
    *run = [full_name, flags, act] {
      absl::Status status = CheckTlsFlags(flags->tls, flags->server);
      if (status.ok()) status = act();
      return status.ok() ? 0 : Fail(full_name, status);
    };
  });
  return command;
}

}  // namespace overtone
