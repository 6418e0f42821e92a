// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/internal/outbox_directory.h"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"

namespace overtone {
namespace {

namespace fs = std::filesystem;

}  // namespace

std::string OutboxPath(const std::string& directory, const std::string& map,
                       const MissionId& mission) {
  return absl::StrCat(directory, "/", map, ".", mission.robot, ".", mission.mission, ".outbox");
}

absl::Status CreateOutboxDirectory(const std::string& directory) {
  std::error_code error;
  fs::create_directories(directory, error);
  if (!error && fs::is_directory(directory, error)) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("outbox_dir: ", directory, ": ", error ? error.message() : "is no directory"));
}

std::vector<MissionOutbox> FindOutboxes(const std::string& directory, const std::string& robot) {
  std::vector<MissionOutbox> found;
  std::error_code error;
  for (fs::directory_iterator it(directory, error), end; !error && it != end; it.increment(error)) {
    const std::vector<std::string> parts = absl::StrSplit(it->path().filename().string(), '.');
    if (parts.size() != 4 || parts[3] != "outbox" || parts[1] != robot) continue;
    MissionOutbox outbox{it->path().string(), parts[0], {parts[1], parts[2]}};
    const bool valid = ValidateId(outbox.map, "map").ok() &&
                       ValidateId(outbox.mission.mission, "mission.mission").ok();
    if (valid) found.push_back(std::move(outbox));
  }
  std::sort(found.begin(), found.end(),
            [](const MissionOutbox& a, const MissionOutbox& b) { return a.path < b.path; });
  return found;
}

}  // namespace overtone
