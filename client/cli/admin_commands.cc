// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/admin_commands.h"

#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "overtone/client/cli/admin_client.h"
#include "overtone/client/cli/admin_flags.h"
#include "overtone/client/cli/map_tables.h"
#include "overtone/client/cli/table.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {
namespace {

absl::Status ShowStatus(const AdminFlags& flags) {
  AdminClient client = flags.Client();
  ASSIGN_OR_RETURN(const std::vector<v1::MapSummary> maps, client.ListMaps());
  if (flags.json) {
    PrintJson(maps);
  } else {
    std::cout << FormatTable(MapRows(maps));
  }
  return absl::OkStatus();
}

absl::Status ShowRobots(const AdminFlags& flags) {
  AdminClient client = flags.Client();
  ASSIGN_OR_RETURN(const std::vector<v1::Robot> robots, client.ListRobots(flags.map));
  if (flags.json) {
    PrintJson(robots);
  } else {
    std::cout << FormatTable(RobotRows(robots));
  }
  return absl::OkStatus();
}

absl::Status ShowMissions(const AdminFlags& flags) {
  AdminClient client = flags.Client();
  ASSIGN_OR_RETURN(const std::vector<v1::Mission> missions, client.ListMissions(flags.map));
  if (flags.json) {
    PrintJson(missions);
    return absl::OkStatus();
  }
  TableRows rows = {{"mission", "anchored", "component", "submaps", "keyframes", "path [m]"}};
  for (const v1::Mission& mission : missions) {
    rows.push_back({absl::StrCat(mission.id().robot(), "/", mission.id().mission()),
                    mission.anchored() ? "yes" : "no", absl::StrCat(mission.component()),
                    absl::StrCat(mission.submaps()), absl::StrCat(mission.keyframes()),
                    absl::StrFormat("%.1f", mission.path_m())});
  }
  std::cout << FormatTable(rows);
  return absl::OkStatus();
}

}  // namespace

void AddAdminCommands(CLI::App* app, std::function<int()>* run) {
  const auto flags = std::make_shared<AdminFlags>();
  AddAdminCommand(
      app, "status", "List a server's maps", {/*map=*/false, /*json=*/true}, flags.get(),
      [flags] { return ShowStatus(*flags); }, run)
      ->footer(
          "cost: half the sum of squared whitened residuals; backlog: clouds and candidates that "
          "are "
          "still to\n"
          "be looked at. --json: a MapSummary of map_admin_service.proto on each line.\n\n"
          "  overtone status\n"
          "  overtone status --server maps.example:7077 --json | jq .revision");
  AddAdminCommand(
      app, "robots", "List a map's robots: link, backlog, clock, last comparison",
      {/*map=*/true, /*json=*/true}, flags.get(), [flags] { return ShowRobots(*flags); }, run)
      ->footer(
          "link: which of the robot's streams are open. received, sent: since the server started. "
          "backlog, clock\n"
          "offset and last comparison are what the robot reported last, ? where it did not. Times "
          "are "
          "UTC.\n"
          "--json: a Robot of map_admin_service.proto on each line.\n\n"
          "  overtone robots --map town\n"
          "  overtone robots --map town --json | jq -r 'select(.uploading|not).robot'");
  AddAdminCommand(
      app, "missions", "List a map's missions", {/*map=*/true, /*json=*/true}, flags.get(),
      [flags] { return ShowMissions(*flags); }, run)
      ->footer(
          "anchored: tied to the map's root component, whose frame is the map's. --json: a Mission "
          "of\n"
          "map_admin_service.proto on each line.\n\n"
          "  overtone missions --map town");
}

}  // namespace overtone
