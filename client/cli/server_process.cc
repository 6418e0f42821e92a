// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/server_process.h"

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "absl/memory/memory.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "absl/strings/strip.h"

namespace overtone {
namespace {

constexpr char kProgram[] = "overtone-mapping-server";
constexpr absl::Duration kStartTimeout = absl::Seconds(30);
constexpr absl::Duration kStopTimeout = absl::Seconds(20);

absl::Status AddLog(const absl::Status& status, const std::string& log_path) {
  return absl::Status(status.code(), absl::StrCat(status.message(), "; see ", log_path));
}

}  // namespace

std::string FindServerProgram() {
  std::error_code error;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
  if (!error) {
    const std::filesystem::path folder = self.parent_path();
    for (const std::filesystem::path& candidate :
         {folder / kProgram, folder / "../../services/mapping_server" / kProgram}) {
      if (access(candidate.c_str(), X_OK) == 0) return candidate.lexically_normal().string();
    }
  }
  return kProgram;
}

absl::StatusOr<std::unique_ptr<ServerProcess>> ServerProcess::Start(
    const std::string& program, const std::vector<std::string>& arguments,
    const std::string& log_path, const std::function<absl::Status()>& interrupted) {
  ChildProcessOptions options;
  options.name = "mapping server";
  options.arguments = {program, "--listen", "127.0.0.1:0"};
  if (std::find(arguments.begin(), arguments.end(), "--data-dir") == arguments.end()) {
    options.arguments.insert(options.arguments.end(), {"--data-dir", ":memory:"});
  }
  options.arguments.insert(options.arguments.end(), arguments.begin(), arguments.end());
  options.stderr_path = log_path;
  absl::StatusOr<std::unique_ptr<ChildProcess>> process = ChildProcess::Start(std::move(options));
  if (!process.ok()) return process.status();
  const absl::StatusOr<std::string> line = (*process)->ReadLine(kStartTimeout, interrupted);
  if (!line.ok()) return AddLog(line.status(), log_path);
  absl::string_view address = *line;
  if (!absl::ConsumePrefix(&address, "listening on ") || address.empty()) {
    return absl::InternalError(absl::StrCat("mapping server said \"", *line,
                                            "\" where \"listening on HOST:PORT\" was expected"));
  }
  return absl::WrapUnique(new ServerProcess(*std::move(process), std::string(address), log_path));
}

ServerProcess::ServerProcess(std::unique_ptr<ChildProcess> process, std::string address,
                             std::string log_path)
    : process_(std::move(process)), address_(std::move(address)), log_path_(std::move(log_path)) {}

absl::Status ServerProcess::CheckAlive(absl::Duration wait) {
  const absl::Status status = process_->CheckAlive(wait);
  return status.ok() ? status : AddLog(status, log_path_);
}

absl::Status ServerProcess::Stop() {
  const absl::Status status = process_->Terminate(kStopTimeout);
  return status.ok() ? status : AddLog(status, log_path_);
}

}  // namespace overtone
