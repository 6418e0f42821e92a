// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/export_command.h"

#include <fstream>
#include <iostream>
#include <map>
#include <memory>
#include <string>

#include "absl/strings/str_cat.h"
#include "overtone/client/cli/admin_client.h"
#include "overtone/client/cli/admin_flags.h"
#include "overtone/client/cli/closure_commands.h"
#include "overtone/client/cli/interrupt.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/id_conversion.h"

namespace overtone {
namespace {

struct ExportFlags : AdminFlags {
  ExportFlags() { timeout_s = 600; }  // clouds are read one by one
  std::string format = "tum";
  std::string out = "-";
  std::string mission;
  double voxel_m = 0.1;
  int64_t max_points = 10'000'000;
};

const std::map<std::string, v1::ExportFormat>& Formats() {
  static const auto* const formats = new std::map<std::string, v1::ExportFormat>{
      {"tum", v1::EXPORT_FORMAT_TUM},     {"kitti", v1::EXPORT_FORMAT_KITTI},
      {"euroc", v1::EXPORT_FORMAT_EUROC}, {"g2o", v1::EXPORT_FORMAT_G2O},
      {"ply", v1::EXPORT_FORMAT_PLY},
  };
  return *formats;
}

absl::StatusOr<v1::ExportMapRequest> Request(const ExportFlags& flags) {
  v1::ExportMapRequest request;
  request.set_map(flags.map);
  request.set_format(Formats().at(flags.format));
  if (!flags.mission.empty()) {
    ASSIGN_OR_RETURN(const MissionId mission, ParseMissionId(flags.mission));
    *request.mutable_mission() = ToProto(mission);
  }
  if (request.format() == v1::EXPORT_FORMAT_PLY) {
    request.set_voxel_m(flags.voxel_m);
    request.set_max_points(flags.max_points);
  }
  return request;
}

// A file is made with its first bytes: an error leaves nothing behind, and what was there stays.
absl::Status Export(const ExportFlags& flags) {
  CatchInterrupts();
  ASSIGN_OR_RETURN(const v1::ExportMapRequest request, Request(flags));
  std::ofstream file;
  std::ostream& out = flags.out == "-" ? std::cout : file;
  AdminClient client = flags.Client();
  const absl::Status status =
      client.ExportMap(request, [&](const std::string& chunk) -> absl::Status {
        RETURN_IF_ERROR(CheckInterrupted());
        if (&out == &file && !file.is_open()) file.open(flags.out, std::ios::binary);
        if (out.write(chunk.data(), static_cast<std::streamsize>(chunk.size()))) {
          return absl::OkStatus();
        }
        return absl::UnavailableError(absl::StrCat("cannot write ", flags.out));
      });
  RETURN_IF_ERROR(status);
  if (&out == &file && !file.is_open()) file.open(flags.out, std::ios::binary);  // an empty map
  if (out.flush()) return absl::OkStatus();
  return absl::UnavailableError(absl::StrCat("cannot write ", flags.out));
}

}  // namespace

void AddExportCommand(CLI::App* app, std::function<int()>* run) {
  const auto flags = std::make_shared<ExportFlags>();
  CLI::App* command = AddAdminCommand(
      app, "export", "Write a map as a file for other programs", {/*map=*/true, /*json=*/false},
      flags.get(), [flags] { return Export(*flags); }, run);
  command
      ->add_option("--format", flags->format,
                   "tum, kitti, euroc: every optimised pose; g2o: the pose graph with the closures "
                   "in use; ply: the clouds of the root component in one")
      ->check(CLI::IsMember(Formats()))
      ->capture_default_str();
  command->add_option("--out", flags->out, "File to write, -: standard output")
      ->type_name("FILE")
      ->capture_default_str();
  command->add_option("--mission", flags->mission, "robot/mission: only this one");
  command
      ->add_option("--voxel", flags->voxel_m, "ply: metres; one point for each cube of this size")
      ->check(CLI::Range(0.001, 100.0))
      ->capture_default_str();
  command
      ->add_option("--max-points", flags->max_points,
                   "ply: cubes are made larger until there are no more points than this")
      ->check(CLI::Range(int64_t{1}, int64_t{10'000'000}))
      ->capture_default_str();
  command->footer(
      "Missions follow each other in the files of poses, each after a comment line that says "
      "whether "
      "it is\n"
      "anchored; --mission writes one alone.\n\n"
      "  overtone export --map town > town.tum\n"
      "  overtone export --map town --format kitti --mission anna/run1 --out anna.txt\n"
      "  overtone export --map town --format ply --voxel 0.05 --out town.ply");
}

}  // namespace overtone
