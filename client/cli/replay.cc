// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/replay.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/clock.h"
#include "overtone/client/cli/admin_client.h"
#include "overtone/client/cli/interrupt.h"
#include "overtone/client/cli/output_files.h"
#include "overtone/client/cli/replay_input.h"
#include "overtone/client/cli/replay_record.h"
#include "overtone/client/cli/results.h"
#include "overtone/client/cli/server_error.h"
#include "overtone/client/cli/server_process.h"
#include "overtone/client/cli/team.h"
#include "overtone/client/cli/tls_flags.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {
namespace {

constexpr absl::Duration kPollInterval = absl::Milliseconds(20);
constexpr absl::Duration kAdminTimeout = absl::Seconds(60);

class Replay {
 public:
  explicit Replay(const ReplayOptions& options) : options_(options) {}

  absl::StatusOr<RunResult> Run() {
    ASSIGN_OR_RETURN(input_, MakeReplayInput(options_));
    absl::StatusOr<RunResult> result = Play();
    if (!result.ok()) return Explain(result.status());
    team_.reset();
    if (server_ != nullptr) RETURN_IF_ERROR(server_->Stop());
    return result;
  }

 private:
  absl::Status StartServer() {
    map_ = options_.map.empty()
               ? absl::FormatTime("replay-%Y%m%d-%H%M%S", absl::Now(), absl::UTCTimeZone())
               : options_.map;
    address_ = options_.server;
    tls_ = options_.tls;
    if (address_.empty()) {
      ASSIGN_OR_RETURN(server_,
                       ServerProcess::Start(FindServerProgram(), ServerArguments(),
                                            options_.out + "/server.log", CheckInterrupted));
      address_ = server_->address();
      tls_ = TlsFiles();  // loopback, plaintext
      std::cerr << "Mapping server " << server_->pid() << " listens on " << address_ << "\n";
    }
    RETURN_IF_ERROR(CheckTlsFlags(tls_, address_));
    admin_ = std::make_unique<AdminClient>(address_, kAdminTimeout, tls_);
    RETURN_IF_ERROR(DeleteOldMap());
    // What the map holds already, when it is one that exists.
    const absl::StatusOr<v1::MapSummary> map = admin_->GetMap(map_);
    if (!map.ok() && !absl::IsNotFound(map.status())) return map.status();
    if (!map.ok()) return absl::OkStatus();
    keyframes_before_ = map->keyframes();
    closures_before_ = map->loop_closures();
    return CheckMissionsAreNew();
  }

  // What is sent under a name that is there already counts as sent before.
  absl::Status CheckMissionsAreNew() {
    ASSIGN_OR_RETURN(const std::vector<v1::Mission> missions, admin_->ListMissions(map_));
    std::set<MissionId> known;
    for (const v1::Mission& mission : missions) {
      known.insert({mission.id().robot(), mission.id().mission()});
    }
    for (const RobotPlan& plan : input_.plans) {
      if (known.count(plan.id) == 0) continue;
      return absl::AlreadyExistsError(absl::StrCat(
          "map ", map_, " has a mission ", ToString(plan.id),
          " already: --mission NAME replays beside it, --map NAME into another map; `overtone "
          "delete "
          "--server ",
          address_, " --map ", map_, " --mission ", ToString(plan.id), "` makes room"));
    }
    return absl::OkStatus();
  }

  absl::Status DeleteOldMap() {
    if (!options_.fresh) return absl::OkStatus();
    const absl::Status deleted = admin_->DeleteMap(map_).status();
    return absl::IsNotFound(deleted) ? absl::OkStatus() : deleted;
  }

  std::vector<std::string> ServerArguments() const {
    if (options_.server_config.empty()) return {};
    return {"--config", options_.server_config};
  }

  absl::Status StartTeam() {
    std::vector<RobotRecording> recordings = MakeRecordings(input_);
    int64_t all_keyframes = 0;
    for (const RobotRecording& recording : recordings) all_keyframes += recording.keyframes.size();
    std::vector<TeamMember> members;
    for (size_t i = 0; i < recordings.size(); ++i) {
      const std::string& name = input_.plans[i].name;
      const std::string folder = absl::StrCat(options_.out, "/", name);
      RETURN_IF_ERROR(MakeFolder(folder));
      RETURN_IF_ERROR(WriteClouds(folder + "/clouds", &recordings[i].observations));
      const std::string file = folder + "/recording.json";
      RETURN_IF_ERROR(WriteRobotRecording(file, recordings[i]));
      ClientFlags client = options_.client;
      if (options_.reduction_percent > 0) {
        client.max_nodes =
            ReducedNodes(client.multi_robot_graph ? all_keyframes : recordings[i].keyframes.size());
      }
      members.push_back({name, file, client.ToArguments()});
      const TlsFiles tls = TlsFilesOfRobot(tls_, options_.robot_certs, name);
      for (std::string& flag : TlsArguments(tls)) members.back().client_arguments.push_back(flag);
    }
    ClearTlsEnvironment();  // every robot has its own
    TeamOptions team;
    team.program = std::filesystem::read_symlink("/proc/self/exe").string();
    team.server = address_;
    team.map = map_;
    team.timeout = absl::Seconds(options_.timeout_s);
    ASSIGN_OR_RETURN(team_, Team::Start(team, members, [this] { return CheckRunning(); }));
    return absl::OkStatus();
  }

  // What --reduction leaves of this many nodes.
  int ReducedNodes(int64_t nodes) const {
    const double kept = (1 - options_.reduction_percent / 100) * static_cast<double>(nodes);
    return std::max(1, static_cast<int>(std::lround(kept)));
  }

  absl::StatusOr<RunResult> Play() {
    RETURN_IF_ERROR(StartServer());
    RETURN_IF_ERROR(StartTeam());
    ReplayRecord record(input_);
    RETURN_IF_ERROR(March(&record));
    return Patiently([&] { return record.Finish(admin_.get(), map_); });
  }

  // A failed call is often only the first to notice that the server has died, or that the user has
  // had enough.
  absl::Status Explain(const absl::Status& status) {
    RETURN_IF_ERROR(CheckInterrupted());
    if (server_ != nullptr) RETURN_IF_ERROR(server_->CheckAlive(absl::Seconds(1)));
    return status;
  }

  // Asked whenever the replay waits, for the robots too.
  absl::Status CheckRunning() {
    RETURN_IF_ERROR(CheckInterrupted());
    if (server_ != nullptr) return server_->CheckAlive();
    const AdminClient::Link link = admin_->CheckLink();
    if (link != AdminClient::Link::kUnknown) NoteServer(link == AdminClient::Link::kUp);
    return absl::OkStatus();
  }

  void NoteServer(bool reachable) {
    if (std::exchange(reachable_, reachable) == reachable) return;
    std::cerr << "server " << address_
              << (reachable ? " is back\n"
                            : absl::StrCat(" cannot be reached; going on when it returns, within ",
                                           options_.timeout_s, " s (--timeout)\n"));
  }

  absl::Status March(ReplayRecord* record) {
    const absl::Time start = absl::Now();
    bool done = false;
    for (int step = 1; !done; ++step) {
      const double time_s = std::min(step * options_.compare_every_s, record->duration_s());
      if (options_.speed > 0)
        RETURN_IF_ERROR(SleepUntil(start + absl::Seconds(time_s / options_.speed)));
      ASSIGN_OR_RETURN(const std::vector<Json> progress,
                       team_->AskAll(absl::StrFormat("advance %.17g", time_s)));
      ASSIGN_OR_RETURN(const uint64_t revision, WaitUntilMapped(progress));
      ASSIGN_OR_RETURN(const std::vector<Json> comparisons,
                       team_->AskAll(absl::StrCat("compare ", revision)));
      RETURN_IF_ERROR(record->Add(comparisons));
      std::cerr << record->ProgressLine(time_s, revision) << "\n";
      done = time_s >= record->duration_s();
    }
    return absl::OkStatus();
  }

  // In slices, so that an interrupt ends it.
  absl::Status SleepUntil(absl::Time when) {
    while (absl::Now() < when) {
      RETURN_IF_ERROR(CheckRunning());
      absl::SleepFor(std::min(when - absl::Now(), absl::Milliseconds(100)));
    }
    return absl::OkStatus();
  }

  // A server that goes away is waited for: the robots have kept what it had not acknowledged. Not
  // one of our own, which nobody starts again.
  template <typename Call>
  auto Patiently(const Call& call) -> decltype(call()) {
    const absl::Time deadline = absl::Now() + absl::Seconds(options_.timeout_s);
    for (;;) {
      auto result = call();
      const bool lost = server_ == nullptr && MayComeBack(result.status());
      NoteServer(!lost);
      if (!lost || absl::Now() >= deadline) return result;
      RETURN_IF_ERROR(SleepUntil(absl::Now() + absl::Milliseconds(500)));
    }
  }

  // The first revision that holds all that the robots have sent, and what the server's front end
  // made of it. The server publishes on its own time; asking is all one can do from outside.
  absl::StatusOr<uint64_t> WaitUntilMapped(const std::vector<Json>& progress) {
    int64_t keyframes = keyframes_before_, closures = closures_before_;
    for (const Json& robot : progress) {
      keyframes += robot.at("keyframes").get<int64_t>();
      closures += robot.at("closures").get<int64_t>();
    }
    const absl::Time deadline = absl::Now() + absl::Seconds(options_.timeout_s);
    for (;;) {
      RETURN_IF_ERROR(CheckRunning());
      ASSIGN_OR_RETURN(const v1::MapSummary map,
                       Patiently([this] { return admin_->GetMap(map_); }));
      if (map.keyframes() >= keyframes && map.loop_closures() >= closures &&
          map.front_end_backlog() == 0 && map.missing_blobs() == 0) {
        return map.revision();
      }
      if (absl::Now() >= deadline) {
        return absl::DeadlineExceededError(absl::StrFormat(
            "the server has mapped %d of %d keyframes and %d of %d loop closures after %g s "
            "(--timeout); %d clouds and candidates wait for its front end, %d clouds are missing",
            map.keyframes(), keyframes, map.loop_closures(), closures, options_.timeout_s,
            map.front_end_backlog(), map.missing_blobs()));
      }
      absl::SleepFor(kPollInterval);
    }
  }

  const ReplayOptions& options_;
  ReplayInput input_;
  std::string map_;
  std::string address_;
  int64_t keyframes_before_ = 0;
  int64_t closures_before_ = 0;
  TlsFiles tls_;
  std::unique_ptr<ServerProcess> server_;
  std::unique_ptr<AdminClient> admin_;
  bool reachable_ = true;
  std::unique_ptr<Team> team_;  // ends before the server
};

std::vector<std::pair<std::string, std::string>> Settings(const ReplayOptions& options) {
  std::vector<std::pair<std::string, std::string>> settings = options.client.Describe();
  settings.emplace_back("compare-every", absl::StrCat(options.compare_every_s, " s"));
  settings.emplace_back("reduction", absl::StrCat(options.reduction_percent, " %"));
  return settings;
}

}  // namespace

absl::StatusOr<RunResult> RunReplay(const ReplayOptions& options) {
  const absl::Time start = absl::Now();
  RETURN_IF_ERROR(MakeFolder(options.out));
  CatchInterrupts();
  Replay replay(options);
  ASSIGN_OR_RETURN(RunResult result, replay.Run());
  result.dataset = options.dataset_name;
  result.command = options.command_line;
  result.settings = Settings(options);
  result.wall_time_s = absl::ToDoubleSeconds(absl::Now() - start);
  RETURN_IF_ERROR(WriteResults(result, options.out));
  return result;
}

}  // namespace overtone
