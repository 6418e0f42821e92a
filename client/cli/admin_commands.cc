// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/admin_commands.h"

#include <fstream>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "google/protobuf/util/json_util.h"
#include "overtone/client/cli/admin_client.h"
#include "overtone/client/cli/closure_names.h"
#include "overtone/client/cli/exit_code.h"
#include "overtone/client/cli/table.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {
namespace {

struct AdminFlags {
  std::string server = "localhost:7077";
  std::string map = "default";
  bool json = false;
  double timeout_s = 10;
  std::string format = "tum";
  std::string out;

  AdminClient Client() const { return AdminClient(server, absl::Seconds(timeout_s)); }
};

// One message on a line, as protobuf's JSON.
template <typename Message>
void PrintJson(const std::vector<Message>& messages) {
  google::protobuf::util::JsonPrintOptions options;
  options.preserve_proto_field_names = true;
  options.always_print_primitive_fields = true;
  for (const Message& message : messages) {
    std::string text;
    if (google::protobuf::util::MessageToJsonString(message, &text, options).ok()) {
      std::cout << text << "\n";
    }
  }
}

absl::Status ShowStatus(const AdminFlags& flags) {
  AdminClient client = flags.Client();
  ASSIGN_OR_RETURN(const std::vector<v1::MapSummary> maps, client.ListMaps());
  if (flags.json) {
    PrintJson(maps);
    return absl::OkStatus();
  }
  std::vector<std::vector<std::string>> rows = {
      {"map", "revision", "missions", "components", "keyframes", "closures", "cost", "solve [s]"}};
  for (const v1::MapSummary& map : maps) {
    rows.push_back({map.map(), absl::StrCat(map.revision()), absl::StrCat(map.missions()),
                    absl::StrCat(map.components()), absl::StrCat(map.keyframes()),
                    absl::StrCat(map.loop_closures()), absl::StrFormat("%.4g", map.cost()),
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

std::string NodeName(const v1::NodeId& node) {
  return absl::StrCat(node.mission().robot(), "/", node.mission().mission(), ":", node.index());
}

absl::Status ShowClosures(const AdminFlags& flags) {
  AdminClient client = flags.Client();
  ASSIGN_OR_RETURN(const std::vector<v1::LoopClosureStatus> closures,
                   client.ListLoopClosures(flags.map));
  if (flags.json) {
    PrintJson(closures);
    return absl::OkStatus();
  }
  std::vector<std::vector<std::string>> rows = {{"from", "to", "verdict", "weight", "chi square"}};
  for (const v1::LoopClosureStatus& closure : closures) {
    rows.push_back({NodeName(closure.loop_closure().from()), NodeName(closure.loop_closure().to()),
                    VerdictName(closure.verdict()), absl::StrFormat("%.3f", closure.weight()),
                    absl::StrFormat("%.2f", closure.chi_square())});
  }
  std::cout << FormatTable(rows);
  return absl::OkStatus();
}

absl::Status Export(const AdminFlags& flags) {
  const auto format = flags.format == "g2o" ? v1::EXPORT_FORMAT_G2O : v1::EXPORT_FORMAT_TUM;
  AdminClient client = flags.Client();
  std::ofstream file(flags.out, std::ios::binary);
  if (!file) return absl::UnavailableError(absl::StrCat("cannot write ", flags.out));
  return client.ExportMap(flags.map, format, &file);
}

CLI::App* AddCommand(CLI::App* app, const std::string& name, const std::string& what,
                     absl::Status (*view)(const AdminFlags&), std::shared_ptr<AdminFlags> flags,
                     std::function<int()>* run) {
  CLI::App* command = app->add_subcommand(name, what);
  command->add_option("--server", flags->server, "host:port of the mapping server")
      ->capture_default_str();
  command->add_option("--timeout", flags->timeout_s, "Seconds to wait for the server")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->callback([=] {
    *run = [=] {
      const absl::Status status = view(*flags);
      return status.ok() ? 0 : Fail(name, status);
    };
  });
  return command;
}

}  // namespace

void AddAdminCommands(CLI::App* app, std::function<int()>* run) {
  const auto add = [&](const std::string& name, const std::string& what,
                       absl::Status (*view)(const AdminFlags&), bool one_map, bool json) {
    auto flags = std::make_shared<AdminFlags>();
    CLI::App* command = AddCommand(app, name, what, view, flags, run);
    if (one_map) command->add_option("--map", flags->map, "Map")->capture_default_str();
    if (json) command->add_flag("--json", flags->json, "One JSON object per line");
    return std::make_pair(command, flags);
  };
  add("status", "List a server's maps", ShowStatus, false, true);
  add("missions", "List a map's missions", ShowMissions, true, true);
  add("closures", "List a map's loop closures with their verdicts", ShowClosures, true, true);
  const auto [command, flags] = add("export", "Write a map to a file", Export, true, false);
  command->add_option("--format", flags->format, "tum or g2o")
      ->check(CLI::IsMember({"tum", "g2o"}))
      ->capture_default_str();
  command->add_option("--out", flags->out, "File to write")->required();
}

}  // namespace overtone
