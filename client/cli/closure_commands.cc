// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/closure_commands.h"

#include <iostream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "nlohmann/json.hpp"
#include "overtone/client/cli/admin_client.h"
#include "overtone/client/cli/admin_flags.h"
#include "overtone/client/cli/closure_names.h"
#include "overtone/client/cli/map_tables.h"
#include "overtone/client/cli/table.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/id_conversion.h"

namespace overtone {
namespace {

struct ClosureFlags : AdminFlags {
  std::string robot;
  std::string mission;
  std::string verdict;
  std::string proposer;
  std::string near;
  double radius_m = 5;
  std::vector<std::string> ids;
  uint64_t revision = 0;
};

// The value of an enum that the command line calls `name`; `name_of` names them all.
template <typename Enum>
absl::StatusOr<Enum> ParseName(absl::string_view flag, const std::string& name,
                               std::string (*name_of)(Enum)) {
  std::vector<std::string> names;
  const auto& values = *google::protobuf::GetEnumDescriptor<Enum>();
  for (int i = 1; i < values.value_count(); ++i) {  // 0: unspecified
    const Enum value = static_cast<Enum>(values.value(i)->number());
    names.push_back(name_of(value));
    if (names.back() == name) return value;
  }
  return absl::InvalidArgumentError(
      absl::StrCat(flag, ": \"", name, "\" is none of ", absl::StrJoin(names, ", ")));
}

std::string Figures(const v1::LoopClosureStatus& closure) {
  if (!closure.has_registration()) return "";
  const v1::RegistrationFigures& figures = closure.registration();
  return absl::StrFormat("%.2f / %.3f m", figures.overlap(), figures.residual_m());
}

void PrintClosures(const std::vector<v1::LoopClosureStatus>& closures) {
  std::vector<std::vector<std::string>> rows = {
      {"id", "proposer", "score", "overlap / residual", "chi square", "verdict", "why"}};
  for (const v1::LoopClosureStatus& closure : closures) {
    rows.push_back({closure.id(), ProposerName(closure.proposer()),
                    closure.score() > 0 ? absl::StrFormat("%.2f", closure.score()) : "",
                    Figures(closure), absl::StrFormat("%.2f", closure.chi_square()),
                    VerdictName(closure.verdict()), closure.reason()});
  }
  std::cout << FormatTable(rows);
}

absl::Status Explain(const ClosureFlags& flags) {
  v1::ExplainLoopClosuresRequest request;
  request.set_map(flags.map);
  request.set_radius_m(flags.radius_m);
  ASSIGN_OR_RETURN(const NodeId node, ParseNodeId(flags.near));
  *request.mutable_node() = ToProto(node);
  AdminClient client = flags.Client();
  ASSIGN_OR_RETURN(const v1::ExplainLoopClosuresResponse response,
                   client.ExplainLoopClosures(request));
  if (flags.json) {
    PrintJson<v1::ExplainLoopClosuresResponse>({response});
    return absl::OkStatus();
  }
  std::cout << response.explanation() << "\n";
  if (response.candidates_size() > 0) {
    std::cout << "\n";
    PrintClosures({response.candidates().begin(), response.candidates().end()});
  }
  return absl::OkStatus();
}

absl::Status ShowClosures(const ClosureFlags& flags) {
  if (!flags.near.empty()) return Explain(flags);
  v1::ListLoopClosuresRequest request;
  request.set_map(flags.map);
  request.set_robot(flags.robot);
  if (!flags.mission.empty()) {
    ASSIGN_OR_RETURN(const MissionId mission, ParseMissionId(flags.mission));
    *request.mutable_mission() = ToProto(mission);
  }
  if (!flags.verdict.empty()) {
    ASSIGN_OR_RETURN(const auto verdict, ParseName("--verdict", flags.verdict, VerdictName));
    request.set_verdict(verdict);
  }
  if (!flags.proposer.empty()) {
    ASSIGN_OR_RETURN(const auto proposer, ParseName("--proposer", flags.proposer, ProposerName));
    request.set_proposer(proposer);
  }
  AdminClient client = flags.Client();
  ASSIGN_OR_RETURN(const std::vector<v1::LoopClosureStatus> closures,
                   client.ListLoopClosures(std::move(request)));
  flags.json ? PrintJson(closures) : PrintClosures(closures);
  return absl::OkStatus();
}

absl::Status DecideAll(const ClosureFlags& flags, const char* done,
                       absl::Status (AdminClient::*decide)(const std::string&,
                                                           const std::string&)) {
  AdminClient client = flags.Client();
  for (const std::string& id : flags.ids) {
    RETURN_IF_ERROR((client.*decide)(flags.map, id));
    if (flags.json) {
      std::cout << nlohmann::json{{"id", id}, {"decision", done}}.dump() << "\n";
    } else {
      std::cout << done << " " << id << "; the next revision holds the result\n";
    }
  }
  return absl::OkStatus();
}

absl::Status ShowRevisions(const AdminFlags& flags) {
  AdminClient client = flags.Client();
  ASSIGN_OR_RETURN(const std::vector<v1::Revision> revisions, client.ListRevisions(flags.map));
  if (flags.json) {
    PrintJson(revisions);
    return absl::OkStatus();
  }
  std::vector<std::vector<std::string>> rows = {{"revision", "published", "anchored", "keyframes",
                                                 "in use +/-", "moved mean/max [m]", "cost",
                                                 "candidates"}};
  for (const v1::Revision& revision : revisions) {
    rows.push_back({absl::StrCat(revision.revision()), ClockTimeText(revision.published()),
                    absl::StrCat(revision.anchored_missions(), " of ", revision.missions()),
                    absl::StrCat(revision.keyframes()),
                    absl::StrCat(revision.accepted_size(), "/", revision.dropped_size()),
                    absl::StrFormat("%.3f/%.3f", revision.mean_move_m(), revision.largest_move_m()),
                    absl::StrFormat("%.4g", revision.cost_after()),
                    VerdictsText(revision.verdicts())});
  }
  std::cout << FormatTable(rows);
  return absl::OkStatus();
}

absl::Status RollBack(const ClosureFlags& flags) {
  AdminClient client = flags.Client();
  ASSIGN_OR_RETURN(const v1::RollBackResponse response, client.RollBack(flags.map, flags.revision));
  if (flags.json) {
    PrintJson<v1::RollBackResponse>({response});
    return absl::OkStatus();
  }
  std::cout << "vetoed " << response.vetoed() << " loop closures that came into use after revision "
            << flags.revision << "; the map goes on in epoch " << response.map_epoch() << "\n";
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<MissionId> ParseMissionId(absl::string_view text) {
  const std::vector<std::string> parts = absl::StrSplit(text, '/');
  if (parts.size() != 2 || !ValidateId(parts[0], "robot").ok() ||
      !ValidateId(parts[1], "mission").ok()) {
    return absl::InvalidArgumentError(absl::StrCat("\"", text, "\": expected robot/mission"));
  }
  return MissionId{parts[0], parts[1]};
}

absl::StatusOr<NodeId> ParseNodeId(absl::string_view text) {
  const std::pair<std::string, std::string> parts = absl::StrSplit(text, absl::MaxSplits(':', 1));
  NodeId node;
  const absl::StatusOr<MissionId> mission = ParseMissionId(parts.first);
  if (!mission.ok() || !absl::SimpleAtoi(parts.second, &node.index) || node.index < 0) {
    return absl::InvalidArgumentError(absl::StrCat("\"", text, "\": expected robot/mission:index"));
  }
  node.mission = *mission;
  return node;
}

void AddClosureCommands(CLI::App* app, std::function<int()>* run) {
  const auto flags = std::make_shared<ClosureFlags>();
  CLI::App* closures = AddAdminCommand(
      app, "closures", "List a map's loop closures, or say why there is none at a place",
      {true, true}, flags.get(), [flags] { return ShowClosures(*flags); }, run);
  closures->add_option("--near", flags->near,
                       "robot/mission:index: is there a loop here, and if not, why");
  closures->add_option("--radius", flags->radius_m, "Metres along the mission that count as near")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  closures->add_option("--robot", flags->robot, "Only with an end in a mission of this robot");
  closures->add_option("--mission", flags->mission,
                       "robot/mission: only with an end in this mission");
  closures->add_option("--verdict", flags->verdict,
                       "Only with this verdict: accepted, quarantined, rejected_overlap, ...");
  closures->add_option("--proposer", flags->proposer,
                       "Only proposed by: robot, robot_score, scan_context");
  closures->footer(
      "What each verdict means and what to do about it is in docs/loop_closures.md. --json: a "
      "LoopClosureStatus\n"
      "of map_admin_service.proto on each line; with --near one ExplainLoopClosuresResponse.\n\n"
      "  overtone closures --map town --verdict quarantined\n"
      "  overtone closures --map town --near anna/run1:120      # why is there no loop?");

  const auto add_ids = [&flags](CLI::App* command) {
    command->add_option("id", flags->ids, "As listed by `overtone closures`")->required();
    command->footer(
        absl::StrCat("Stands until it is decided otherwise, also after a restart.\n"
                     "--json: {\"id\", \"decision\"} for each.\n\n  overtone ",
                     command->get_name(), " --map town 'anna/run1:15>bert/run1:3#0'"));
  };
  add_ids(AddAdminCommand(
      app, "veto", "Take loop closures out of the map: it is rebuilt without them", {true, true},
      flags.get(), [flags] { return DecideAll(*flags, "vetoed", &AdminClient::VetoLoopClosure); },
      run));
  add_ids(AddAdminCommand(
      app, "force", "Use loop closures whatever the checks say", {true, true}, flags.get(),
      [flags] { return DecideAll(*flags, "forced", &AdminClient::ForceLoopClosure); }, run));
  AddAdminCommand(
      app, "revisions", "List what each revision of a map changed", {true, true}, flags.get(),
      [flags] { return ShowRevisions(*flags); }, run)
      ->footer(
          "Newest first; the server keeps the last 1000. in use +/-: closures that came into "
          "and went out of use.\n"
          "--json: a Revision of map_admin_service.proto on each line.\n\n"
          "  overtone revisions --map town");
  CLI::App* rollback = AddAdminCommand(
      app, "rollback", "Veto every loop closure that came into use after a revision", {true, true},
      flags.get(), [flags] { return RollBack(*flags); }, run);
  rollback->add_option("revision", flags->revision, "As listed by `overtone revisions`")
      ->required();
  rollback->footer(
      "Submaps stay; the map goes on in a new epoch, and robots retract what came from the vetoed "
      "closures.\n"
      "--json: a RollBackResponse of map_admin_service.proto.\n\n"
      "  overtone rollback --map town 17");
}

}  // namespace overtone
