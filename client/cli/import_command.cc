// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/import_command.h"

#include <algorithm>
#include <iostream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "nlohmann/json.hpp"
#include "overtone/client/cli/admin_client.h"
#include "overtone/client/cli/admin_flags.h"
#include "overtone/client/cli/import.h"
#include "overtone/client/cli/interrupt.h"
#include "overtone/client/cli/tls_flags.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {
namespace {

constexpr absl::Duration kPollInterval = absl::Milliseconds(50);

struct ImportFlags : AdminFlags {
  ImportFlags() { timeout_s = 300; }
  std::vector<std::string> files;
  std::string robot_certs;
  ImportOptions options;
};

void Report(const ImportFlags& flags, const RobotRecording& recording, int64_t there) {
  const size_t keyframes = recording.keyframes.size();
  const bool all = there == static_cast<int64_t>(keyframes);
  if (flags.json) {
    std::cout << nlohmann::json{{"map", flags.map},
                                {"mission", ToString(recording.id)},
                                {"keyframes", keyframes},
                                {"loop_closures", recording.closures.size()},
                                {"already_there", there}}
                     .dump()
              << std::endl;
    return;
  }
  std::cout << ToString(recording.id) << ": " << keyframes << " keyframes and "
            << recording.closures.size() << " loop closures ";
  if (all) {
    std::cout << "are in map " << flags.map << " already" << std::endl;
  } else {
    std::cout << "into map " << flags.map << std::endl;
  }
}

void LogToStderr(LogLevel level, absl::string_view message) {
  // A map comes into being with its first submap; closures that overtake it go up again.
  const bool overtaken = absl::StartsWith(message, "loop closures not sent: NOT_FOUND");
  if (level != LogLevel::kInfo && !overtaken) std::cerr << absl::StrCat(message, "\n");
}

absl::Status ImportOne(const ImportFlags& flags, AdminClient& admin,
                       const RobotRecording& recording) {
  ASSIGN_OR_RETURN(const int64_t there, KeyframesThere(admin, flags.map, recording));
  MappingClientOptions client;
  client.server = flags.server;
  client.map = flags.map;
  client.tls = flags.robot_certs.empty()
                   ? flags.tls
                   : TlsFilesOfRobot(flags.tls, flags.robot_certs, recording.id.robot);
  client.log = LogToStderr;
  RETURN_IF_ERROR(CheckTlsFlags(client.tls, flags.server));
  RETURN_IF_ERROR(UploadRecording(recording, std::move(client), absl::Seconds(flags.timeout_s)));
  Report(flags, recording, there);
  return absl::OkStatus();
}

// Until a revision holds all of it, so that the next command finds it.
absl::Status WaitUntilMapped(const ImportFlags& flags, AdminClient& admin,
                             const std::vector<RobotRecording>& recordings) {
  const absl::Time deadline = absl::Now() + absl::Seconds(flags.timeout_s);
  for (;;) {
    RETURN_IF_ERROR(CheckInterrupted());
    ASSIGN_OR_RETURN(const v1::MapSummary map, admin.GetMap(flags.map));
    ASSIGN_OR_RETURN(const std::vector<v1::Mission> missions, admin.ListMissions(flags.map));
    const auto is_mapped = [&missions](const RobotRecording& recording) {
      return std::any_of(missions.begin(), missions.end(), [&](const v1::Mission& mission) {
        return mission.id().robot() == recording.id.robot &&
               mission.id().mission() == recording.id.mission &&
               mission.keyframes() == static_cast<int64_t>(recording.keyframes.size());
      });
    };
    if (map.front_end_backlog() == 0 &&
        std::all_of(recordings.begin(), recordings.end(), is_mapped)) {
      return absl::OkStatus();
    }
    if (absl::Now() >= deadline) {
      return absl::DeadlineExceededError(
          absl::StrCat("all is stored, but not mapped after ", flags.timeout_s, " s (--timeout)"));
    }
    absl::SleepFor(kPollInterval);
  }
}

absl::Status Import(const ImportFlags& flags) {
  CatchInterrupts();
  std::vector<RobotRecording> recordings;
  for (const std::string& file : flags.files) {  // all of them, before anything is sent
    ASSIGN_OR_RETURN(const ImportSource source, ParseImportSource(file));
    ASSIGN_OR_RETURN(RobotRecording recording, ReadImport(source, flags.options));
    for (const RobotRecording& other : recordings) {
      if (other.id != recording.id) continue;
      return absl::InvalidArgumentError(
          absl::StrCat(file, ": robot ", source.robot, " is given twice; say ROBOT:FILE"));
    }
    recordings.push_back(std::move(recording));
  }
  AdminClient admin = flags.Client();
  RETURN_IF_ERROR(admin.ListMaps().status());  // or the robots would wait for it
  for (const RobotRecording& recording : recordings) {
    RETURN_IF_ERROR(CheckInterrupted());
    RETURN_IF_ERROR(ImportOne(flags, admin, recording));
  }
  return WaitUntilMapped(flags, admin, recordings);
}

}  // namespace

void AddImportCommand(CLI::App* app, std::function<int()>* run) {
  const auto flags = std::make_shared<ImportFlags>();
  CLI::App* command = AddAdminCommand(
      app, "import", "Upload trajectories and pose graphs of other programs as missions",
      {/*map=*/true, /*json=*/true}, flags.get(), [flags] { return Import(*flags); }, run);
  command
      ->add_option("file", flags->files,
                   "[ROBOT:]FILE of TUM rows \"t x y z qx qy qz qw\", or FILE.g2o; without ROBOT "
                   "the file's name names it")
      ->type_name("FILE")
      ->required();
  ImportOptions* options = &flags->options;
  command->add_option("--mission", options->mission, "What to call each robot's mission")
      ->capture_default_str();
  command
      ->add_option("--keyframe-distance", options->keyframe_distance_m,
                   "Metres between keyframes [0.4; g2o: every pose]")
      ->check(CLI::NonNegativeNumber);
  command
      ->add_option("--keyframe-rotation", options->keyframe_rotation_rad,
                   "Radians between keyframes [0.5]")
      ->check(CLI::NonNegativeNumber);
  command->add_option("--odometry-sigma", options->odometry_sigma,
                      "How far a TUM trajectory is trusted: translation=M,rotation=RAD (after 1 "
                      "m),turn=RAD (after turning 1 rad)");
  command
      ->add_option("--tls-robot-certs", flags->robot_certs,
                   "Folder of robot-NAME.crt and robot-NAME.key, as `overtone certs` writes them; "
                   "the other --tls flags are then the operator's")
      ->envname("OVERTONE_TLS_ROBOT_CERTS")
      ->group("Transport security");
  command->footer(
      "A g2o file brings its odometry edges as the trajectory and its other edges as loop "
      "closures. "
      "Importing a\n"
      "file again changes nothing, and goes on where an import was cut off. For recordings with "
      "sensors, and to\n"
      "measure what a correction does, there is `overtone replay`.\n"
      "--json: {\"map\", \"mission\", \"keyframes\", \"loop_closures\", \"already_there\"} for "
      "each "
      "file.\n\n"
      "  overtone import --map town anna.tum bert:run7/slam.txt\n"
      "  overtone import --map sphere sphere2500.g2o && overtone export --map sphere --format g2o");
}

}  // namespace overtone
