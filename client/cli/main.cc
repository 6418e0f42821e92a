// SPDX-License-Identifier: Apache-2.0
#include <functional>

#include "CLI/CLI.hpp"
#include "overtone/client/cli/admin_commands.h"
#include "overtone/client/cli/certs_command.h"
#include "overtone/client/cli/closure_commands.h"
#include "overtone/client/cli/config_command.h"
#include "overtone/client/cli/evaluate_command.h"
#include "overtone/client/cli/maintenance_commands.h"
#include "overtone/client/cli/replay_command.h"
#include "overtone/client/cli/robot_command.h"
#include "overtone/client/cli/simulate_command.h"

int main(int argc, char** argv) {
  CLI::App app("Overtone: collaborative multi-robot mapping", "overtone");
  app.set_version_flag("--version", OVERTONE_VERSION);
  app.require_subcommand(1);
  app.get_formatter()->column_width(36);
  app.footer("Exit codes: 0 done, 1 failed, 2 wrong input, 130 interrupted.");
  std::function<int()> run;
  overtone::AddReplayCommand(&app, &run);
  overtone::AddRobotCommand(&app, &run);
  overtone::AddSimulateCommand(&app, &run);
  overtone::AddEvaluateCommand(&app, &run);
  overtone::AddAdminCommands(&app, &run);
  overtone::AddClosureCommands(&app, &run);
  overtone::AddCertsCommand(&app, &run);
  overtone::AddMaintenanceCommands(&app, &run);
  overtone::AddConfigCommand(&app, &run);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  return run();
}
