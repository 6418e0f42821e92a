// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/maintenance_commands.h"

#include <unistd.h>

#include <iostream>
#include <memory>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "nlohmann/json.hpp"
#include "overtone/client/cli/admin_client.h"
#include "overtone/client/cli/admin_flags.h"
#include "overtone/client/cli/backup_file.h"
#include "overtone/client/cli/closure_commands.h"
#include "overtone/client/cli/interrupt.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/id_conversion.h"

namespace overtone {
namespace {

struct MaintenanceFlags : AdminFlags {
  MaintenanceFlags() { timeout_s = 3600; }  // a large map over a slow link
  std::string file;
  std::string mission;
  bool replace = false;
  bool yes = false;
};

// On one line of a terminal; a script's log is spared.
void ShowProgress(const char* what, int64_t bytes, int64_t total) {
  if (!isatty(STDERR_FILENO) || total <= 0) return;
  std::cerr << absl::StrFormat("\r%s: %.1f of %.1f MB%s", what, 1e-6 * static_cast<double>(bytes),
                               1e-6 * static_cast<double>(total), bytes == total ? "\n" : "")
            << std::flush;
}

std::string Content(const v1::StoreReport& report) {
  return absl::StrCat(report.missions(), " missions, ", report.submaps(), " submaps, ",
                      report.blobs(), " clouds, ", report.loop_closures(), " loop closures, ",
                      report.findings(), " findings, ", report.bytes_on_disk(), " bytes on disk");
}

void PrintLosses(const v1::StoreReport& report) {
  for (const std::string& loss : report.losses()) std::cout << "lost: " << loss << "\n";
  const int64_t more = report.num_losses() - report.losses_size();
  if (more > 0) std::cout << "lost: " << more << " more\n";
}

absl::Status Backup(const MaintenanceFlags& flags) {
  CatchInterrupts();
  ASSIGN_OR_RETURN(const auto file, BackupFileWriter::Create(flags.file));
  int64_t bytes = 0;
  AdminClient client = flags.Client();
  ASSIGN_OR_RETURN(const v1::BackupHeader header,
                   client.BackupMap(flags.map,
                                    [&](const v1::BackupHeader& announced,
                                        const std::string& chunk) -> absl::Status {
                                      RETURN_IF_ERROR(CheckInterrupted());
                                      bytes += static_cast<int64_t>(chunk.size());
                                      ShowProgress("backup", bytes, announced.total_bytes());
                                      return file->Append(chunk);
                                    }));
  RETURN_IF_ERROR(file->Commit());
  const std::string sha256 = absl::BytesToHexString(header.sha256());
  if (flags.json) {
    std::cout << nlohmann::json{{"map", flags.map},
                                {"file", flags.file},
                                {"bytes", bytes},
                                {"sha256", sha256}}
                     .dump()
              << "\n";
  } else {
    std::cout << "map " << flags.map << ": " << bytes << " bytes in " << flags.file << ", SHA-256 "
              << sha256 << "\n";
  }
  return absl::OkStatus();
}

absl::Status Restore(const MaintenanceFlags& flags) {
  CatchInterrupts();
  ASSIGN_OR_RETURN(const auto file, BackupFileReader::Open(flags.file));
  v1::RestoreHeader header;
  header.set_map(flags.map);
  header.set_total_bytes(file->bytes());
  header.set_sha256(file->sha256());
  header.set_replace(flags.replace);
  int64_t bytes = 0;
  AdminClient client = flags.Client();
  absl::StatusOr<v1::RestoreMapResponse> response =
      client.RestoreMap(header, [&]() -> absl::StatusOr<std::string> {
        RETURN_IF_ERROR(CheckInterrupted());
        ASSIGN_OR_RETURN(std::string chunk, file->Next());
        if (chunk.empty()) return chunk;
        bytes += static_cast<int64_t>(chunk.size());
        ShowProgress("restore", bytes, file->bytes());
        return chunk;
      });
  if (absl::IsAlreadyExists(response.status())) {
    return absl::AlreadyExistsError(
        absl::StrCat(response.status().message(), "; --replace puts the backup in its place"));
  }
  RETURN_IF_ERROR(response.status());
  if (flags.json) {
    PrintJson<v1::RestoreMapResponse>({*response});
    return absl::OkStatus();
  }
  std::cout << "map " << flags.map << " restored from " << flags.file << ": "
            << Content(response->report()) << "; it goes on in epoch " << response->map_epoch()
            << "\n";
  PrintLosses(response->report());
  return absl::OkStatus();
}

absl::Status Verify(const MaintenanceFlags& flags) {
  AdminClient client = flags.Client();
  ASSIGN_OR_RETURN(const v1::StoreReport report, client.VerifyMap(flags.map));
  if (flags.json) {
    PrintJson<v1::StoreReport>({report});
  } else {
    std::cout << "map " << flags.map << ": " << Content(report)
              << (report.num_losses() == 0 ? "; all is whole\n" : "\n");
    PrintLosses(report);
  }
  if (report.num_losses() == 0) return absl::OkStatus();
  return absl::DataLossError(absl::StrCat("map ", flags.map, ": ", report.num_losses(), " losses"));
}

template <typename Response>
void PrintDeleted(const MaintenanceFlags& flags, const std::string& what,
                  const Response& response) {
  if (flags.json) return PrintJson<Response>({response});
  std::cout << "deleted " << what << "; " << response.freed_bytes() << " bytes freed\n";
}

absl::Status Delete(const MaintenanceFlags& flags) {
  MissionId mission;
  std::string what = absl::StrCat("map ", flags.map);
  if (!flags.mission.empty()) {
    ASSIGN_OR_RETURN(mission, ParseMissionId(flags.mission));
    what = absl::StrCat("mission ", flags.mission, " of map ", flags.map);
  }
  if (!flags.yes) {
    std::istream* const in = isatty(STDIN_FILENO) ? &std::cin : nullptr;
    RETURN_IF_ERROR(ConfirmDeletion(what, in, &std::cerr));
  }
  AdminClient client = flags.Client();
  if (flags.mission.empty()) {
    ASSIGN_OR_RETURN(const v1::DeleteMapResponse response, client.DeleteMap(flags.map));
    PrintDeleted(flags, what, response);
  } else {
    ASSIGN_OR_RETURN(const v1::DeleteMissionResponse response,
                     client.DeleteMission(flags.map, mission));
    PrintDeleted(flags, what, response);
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status ConfirmDeletion(const std::string& what, std::istream* in, std::ostream* out) {
  if (in == nullptr) {
    return absl::InvalidArgumentError(
        absl::StrCat("--yes is needed to delete ", what, " where nobody can be asked"));
  }
  *out << "Delete " << what << " and all that is stored of it? [y/N] " << std::flush;
  std::string answer;
  std::getline(*in, answer);
  if (answer == "y" || answer == "Y" || answer == "yes") return absl::OkStatus();
  return absl::CancelledError("nothing is deleted");
}

void AddMaintenanceCommands(CLI::App* app, std::function<int()>* run) {
  const auto flags = std::make_shared<MaintenanceFlags>();
  const auto add = [&](const char* name, const char* what,
                       absl::Status (*act)(const MaintenanceFlags&)) {
    return AddAdminCommand(
        app, name, what, {/*map=*/true, /*json=*/true}, flags.get(),
        [flags, act] { return act(*flags); }, run);
  };
  CLI::App* backup =
      add("backup", "Copy all that is stored of a map to a file, while robots upload", Backup);
  backup->add_option("--output", flags->file, "File to write")->type_name("FILE")->required();
  backup->footer(
      "The file is checked against the SHA-256 that the server announces, and there only when it "
      "is "
      "whole.\n"
      "--json: {\"map\", \"file\", \"bytes\", \"sha256\"}.\n\n"
      "  overtone backup --map town --output town.overtone");
  CLI::App* restore = add("restore", "Make a map from a backup", Restore);
  restore->get_option("--map")->required();
  restore->add_option("file", flags->file, "What `overtone backup` wrote")
      ->type_name("FILE")
      ->required();
  restore->footer(
      "The server checks the file as a whole before it replaces anything; robots then go on with "
      "the "
      "new map.\n"
      "--json: a RestoreMapResponse of map_admin_service.proto.\n\n"
      "  overtone restore --map town town.overtone --replace");
  restore->add_flag("--replace", flags->replace, "In the place of the map of that name");
  add("verify", "Check all that is stored of a map; exit code 1: something is lost", Verify)
      ->footer(
          "Reads every record against its checksum while the map is served. --json: a StoreReport "
          "of\n"
          "map_admin_service.proto.\n\n"
          "  overtone verify --map town");
  CLI::App* remove = add("delete", "Delete a map or one of its missions for good", Delete);
  remove->get_option("--map")->required();
  remove->add_option("--mission", flags->mission, "robot/mission: only this one");
  remove->add_flag("--yes", flags->yes, "Do not ask");
  remove->footer(
      "There is no way back but a backup. --json: a DeleteMapResponse or DeleteMissionResponse.\n\n"
      "  overtone delete --map town --mission anna/run1\n"
      "  overtone delete --map town --yes");
}

}  // namespace overtone
