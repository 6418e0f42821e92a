// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>
#include <functional>
#include <string>

#include "CLI/CLI.hpp"
#include "overtone/client/cli/admin_commands.h"
#include "overtone/client/cli/certs_command.h"
#include "overtone/client/cli/closure_commands.h"
#include "overtone/client/cli/completion_command.h"
#include "overtone/client/cli/config_command.h"
#include "overtone/client/cli/evaluate_command.h"
#include "overtone/client/cli/exit_code.h"
#include "overtone/client/cli/export_command.h"
#include "overtone/client/cli/health_command.h"
#include "overtone/client/cli/import_command.h"
#include "overtone/client/cli/maintenance_commands.h"
#include "overtone/client/cli/replay_command.h"
#include "overtone/client/cli/report_command.h"
#include "overtone/client/cli/robot_command.h"
#include "overtone/client/cli/simulate_command.h"
#include "overtone/client/cli/watch_command.h"

int main(int argc, char** argv) {
  // gRPC's own lines about what our sentences say; who sets it gets them.
  setenv("GRPC_VERBOSITY", "NONE", /*overwrite=*/0);
  CLI::App app("Overtone: collaborative multi-robot mapping", "overtone");
  app.set_version_flag("--version", OVERTONE_VERSION);
  app.require_subcommand(1);
  app.get_formatter()->column_width(36);
  app.footer(std::string("`overtone COMMAND --help` shows flags and examples.\n") +
             overtone::kExitCodes);
  std::function<int()> run;
  overtone::AddReplayCommand(&app, &run);
  overtone::AddRobotCommand(&app, &run);
  overtone::AddSimulateCommand(&app, &run);
  overtone::AddEvaluateCommand(&app, &run);
  overtone::AddAdminCommands(&app, &run);
  overtone::AddWatchCommand(&app, &run);
  overtone::AddClosureCommands(&app, &run);
  overtone::AddExportCommand(&app, &run);
  overtone::AddImportCommand(&app, &run);
  overtone::AddReportCommand(&app, &run);
  overtone::AddMaintenanceCommands(&app, &run);
  overtone::AddConfigCommand(&app, &run);
  overtone::AddHealthCommand(&app, &run);
  overtone::AddCertsCommand(&app, &run);
  overtone::AddCompletionCommand(&app, &run);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? overtone::kDone : overtone::kWrongInput;
  }
  return run();
}
