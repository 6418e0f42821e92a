// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/report_command.h"

#include <iostream>
#include <memory>
#include <string>

#include "absl/strings/str_cat.h"
#include "nlohmann/json.hpp"
#include "overtone/client/cli/admin_client.h"
#include "overtone/client/cli/admin_flags.h"
#include "overtone/client/cli/map_report.h"
#include "overtone/client/cli/report.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {
namespace {

struct ReportFlags : AdminFlags {
  ReportFlags() { timeout_s = 60; }
  std::string out = "report.html";
};

absl::Status Report(const ReportFlags& flags) {
  AdminClient client = flags.Client();
  ASSIGN_OR_RETURN(RunResult result, FetchMap(client, flags.map));
  result.command = absl::StrCat("overtone report --server ", flags.server, " --map ", flags.map);
  if (flags.out == "-") {
    std::cout << RenderReport(result) << std::flush;
    return std::cout ? absl::OkStatus() : absl::UnavailableError("standard output is closed");
  }
  RETURN_IF_ERROR(WriteReport(result, flags.out));
  if (flags.json) {
    std::cout << nlohmann::json{{"map", flags.map},
                                {"file", flags.out},
                                {"revision", result.revision},
                                {"missions", result.robots.size()},
                                {"loop_closures", result.closures.size()}}
                     .dump()
              << "\n";
  } else {
    std::cout << "map " << flags.map << ", revision " << result.revision << ": "
              << result.robots.size() << " missions and " << result.closures.size()
              << " loop closures in " << flags.out << "\n";
  }
  return absl::OkStatus();
}

}  // namespace

void AddReportCommand(CLI::App* app, std::function<int()>* run) {
  const auto flags = std::make_shared<ReportFlags>();
  CLI::App* command = AddAdminCommand(
      app, "report", "Write a map as one HTML page that opens offline",
      {/*map=*/true, /*json=*/true}, flags.get(), [flags] { return Report(*flags); }, run);
  command->add_option("--out", flags->out, "File to write, -: standard output")
      ->type_name("FILE")
      ->capture_default_str();
  command->footer(
      "Every mission before and after, loop closures by verdict, and where the robots' last "
      "comparisons found a\n"
      "discrepancy. --json: {\"map\", \"file\", \"revision\", \"missions\", \"loop_closures\"}.\n\n"
      "  overtone report --map town --out town.html");
}

}  // namespace overtone
