// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/admin_flags.h"

#include <memory>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "google/protobuf/util/json_util.h"
#include "overtone/client/cli/exit_code.h"
#include "overtone/client/cli/server_error.h"
#include "overtone/client/cli/tls_flags.h"

namespace overtone {
namespace {

std::string MapsThereAre(const AdminFlags& flags) {
  const absl::StatusOr<std::vector<v1::MapSummary>> maps = flags.Client().ListMaps();
  if (!maps.ok()) return "";
  if (maps->empty()) return "; it has no map yet: one comes into being with its first submap";
  std::vector<std::string> names;
  for (const v1::MapSummary& map : *maps) names.push_back(map.map());
  return absl::StrCat("; there is ", absl::StrJoin(names, ", "));
}

absl::Status WithWhatThereIs(const AdminFlags& flags, const absl::Status& status) {
  if (!absl::IsNotFound(status) || !IsFromServer(status)) return status;
  if (absl::StrContains(status.message(), absl::StrCat("map: there is no '", flags.map, "'"))) {
    return WithHint(status, MapsThereAre(flags));
  }
  if (absl::StrContains(status.message(), ": mission: ")) {
    return WithHint(status, absl::StrCat("; `overtone missions --map ", flags.map, "` lists them"));
  }
  return status;
}

}  // namespace

std::string ToJson(const google::protobuf::Message& message) {
  google::protobuf::util::JsonPrintOptions options;
  options.preserve_proto_field_names = true;
  options.always_print_primitive_fields = true;
  std::string text;
  const auto status = google::protobuf::util::MessageToJsonString(message, &text, options);
  return status.ok() ? text : "{}";  // never: the messages are our own
}

CLI::App* AddAdminCommand(CLI::App* app, const std::string& name, const std::string& what,
                          AdminFlagSet set, AdminFlags* flags, std::function<absl::Status()> act,
                          std::function<int()>* run) {
  CLI::App* command = app->add_subcommand(name, what);
  // CLI11 reads the environment for commands that were not given, too: those that share `flags`
  // must not write over what this one was told.
  const auto own = std::make_shared<AdminFlags>(*flags);
  command->add_option("--server", own->server, "host:port of the mapping server")
      ->envname("OVERTONE_SERVER")
      ->capture_default_str();
  command->add_option("--timeout", own->timeout_s, "Seconds to wait for the server")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  AddTlsFlags(command, &own->tls);
  if (set.map) command->add_option("--map", own->map, "Map")->capture_default_str();
  if (set.json) command->add_flag("--json", own->json, "One JSON object per line");
  const std::string full_name = app->get_parent() == nullptr ? name : app->get_name() + " " + name;
  command->callback([full_name, run, flags, own, set, act = std::move(act)] {
    *flags = *own;
    *run = [full_name, flags, set, act]() -> int {
      absl::Status status = CheckTlsFlags(flags->tls, flags->server);
      if (status.ok()) status = WithWhatThereIs(*flags, act());
      if (status.ok()) return kDone;
      const int code = Fail(full_name, status);
      return set.one_failure ? kFailed : code;
    };
  });
  return command;
}

}  // namespace overtone
