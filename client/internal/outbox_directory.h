// SPDX-License-Identifier: Apache-2.0
// Which files the outboxes of a robot's missions have.
#ifndef OVERTONE_CLIENT_INTERNAL_OUTBOX_DIRECTORY_H_
#define OVERTONE_CLIENT_INTERNAL_OUTBOX_DIRECTORY_H_

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "overtone/core/common/ids.h"

namespace overtone {

struct MissionOutbox {
  std::string path;
  std::string map;
  MissionId mission;
};

// "<directory>/<map>.<robot>.<mission>.outbox": ids have no dots.
std::string OutboxPath(const std::string& directory, const std::string& map,
                       const MissionId& mission);

// InvalidArgument naming outbox_dir: it does not exist and cannot be made, or is no directory.
absl::Status CreateOutboxDirectory(const std::string& directory);

// The outboxes of this robot, whatever their map, sorted by path; empty if the directory cannot be
// read.
std::vector<MissionOutbox> FindOutboxes(const std::string& directory, const std::string& robot);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_INTERNAL_OUTBOX_DIRECTORY_H_
