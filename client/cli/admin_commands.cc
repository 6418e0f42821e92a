// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/admin_commands.h"

#include <fstream>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "overtone/client/cli/admin_client.h"
#include "overtone/client/cli/admin_flags.h"
#include "overtone/client/cli/table.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {
namespace {

struct ExportFlags : AdminFlags {
  std::string format = "tum";
  std::string out;
};

absl::Status ShowStatus(const AdminFlags& flags) {
  AdminClient client = flags.Client();
  ASSIGN_OR_RETURN(const std::vector<v1::MapSummary> maps, client.ListMaps());
  if (flags.json) {
    PrintJson(maps);
    return absl::OkStatus();
  }
  std::vector<std::vector<std::string>> rows = {{"map", "revision", "missions", "components",
                                                 "keyframes", "in use/candidates", "landmarks",
                                                 "clouds", "backlog", "cost", "solve [s]"}};
  for (const v1::MapSummary& map : maps) {
    int64_t in_use = 0;
    for (const v1::VerdictCount& count : map.verdicts()) {
      if (count.verdict() == v1::LOOP_CLOSURE_VERDICT_ACCEPTED ||
          count.verdict() == v1::LOOP_CLOSURE_VERDICT_FORCED_BY_OPERATOR) {
        in_use += count.count();
      }
    }
    rows.push_back({map.map(), absl::StrCat(map.revision()), absl::StrCat(map.missions()),
                    absl::StrCat(map.components()), absl::StrCat(map.keyframes()),
                    absl::StrCat(in_use, "/", map.loop_closures()), absl::StrCat(map.landmarks()),
                    absl::StrCat(map.clouds()), absl::StrCat(map.front_end_backlog()),
                    absl::StrFormat("%.4g", map.cost()),
                    absl::StrFormat("%.3f", map.optimisation_s())});
  }
  std::cout << FormatTable(rows);
  return absl::OkStatus();
}

absl::Status ShowMissions(const AdminFlags& flags) {
  AdminClient client = flags.Client();
  ASSIGN_OR_RETURN(const std::vector<v1::Mission> missions, client.ListMissions(flags.map));
  if (flags.json) {
    PrintJson(missions);
    return absl::OkStatus();
  }
  std::vector<std::vector<std::string>> rows = {
      {"mission", "anchored", "component", "submaps", "keyframes", "path [m]"}};
  for (const v1::Mission& mission : missions) {
    rows.push_back({absl::StrCat(mission.id().robot(), "/", mission.id().mission()),
                    mission.anchored() ? "yes" : "no", absl::StrCat(mission.component()),
                    absl::StrCat(mission.submaps()), absl::StrCat(mission.keyframes()),
                    absl::StrFormat("%.1f", mission.path_m())});
  }
  std::cout << FormatTable(rows);
  return absl::OkStatus();
}

absl::Status Export(const ExportFlags& flags) {
  const auto format = flags.format == "g2o" ? v1::EXPORT_FORMAT_G2O : v1::EXPORT_FORMAT_TUM;
  AdminClient client = flags.Client();
  std::ofstream file(flags.out, std::ios::binary);
  if (!file) return absl::UnavailableError(absl::StrCat("cannot write ", flags.out));
  return client.ExportMap(flags.map, format, &file);
}

}  // namespace

void AddAdminCommands(CLI::App* app, std::function<int()>* run) {
  const auto flags = std::make_shared<ExportFlags>();
  AddAdminCommand(
      app, "status", "List a server's maps", {/*map=*/false, /*json=*/true}, flags.get(),
      [flags] { return ShowStatus(*flags); }, run);
  AddAdminCommand(
      app, "missions", "List a map's missions", {/*map=*/true, /*json=*/true}, flags.get(),
      [flags] { return ShowMissions(*flags); }, run);
  CLI::App* command = AddAdminCommand(
      app, "export", "Write a map to a file", {/*map=*/true, /*json=*/false}, flags.get(),
      [flags] { return Export(*flags); }, run);
  command->add_option("--format", flags->format, "tum or g2o")
      ->check(CLI::IsMember({"tum", "g2o"}))
      ->capture_default_str();
  command->add_option("--out", flags->out, "File to write")->required();
}

}  // namespace overtone
