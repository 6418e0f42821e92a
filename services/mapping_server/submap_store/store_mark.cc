// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/submap_store/store_mark.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>

namespace overtone {
namespace {

// store_id, log_end, commits, checksum. In one write, within a sector.
constexpr size_t kIdBytes = 16;
constexpr size_t kMarkBytes = kIdBytes + 2 * sizeof(int64_t) + 16;

}  // namespace

std::string MarkPath(const std::string& path) { return path + "-mark"; }

StoreMark::StoreMark(const std::string& path) {
  if (path.empty()) return;
  fd_ = open(MarkPath(path).c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0644);
}

StoreMark::~StoreMark() {
  if (fd_ >= 0) close(fd_);
}

absl::optional<StateRow> StoreMark::Read(const std::string& path) {
  char bytes[kMarkBytes];
  const int fd = open(MarkPath(path).c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) return absl::nullopt;
  const ssize_t size = pread(fd, bytes, kMarkBytes, 0);
  close(fd);
  if (size != static_cast<ssize_t>(kMarkBytes)) return absl::nullopt;
  StateRow state;
  state.store_id.assign(bytes, kIdBytes);
  std::memcpy(&state.log_end, bytes + kIdBytes, sizeof(int64_t));
  std::memcpy(&state.commits, bytes + kIdBytes + sizeof(int64_t), sizeof(int64_t));
  const std::string checksum(bytes + kMarkBytes - 16, 16);
  if (checksum != Checksum(state)) return absl::nullopt;
  return state;
}

void StoreMark::Write(const StateRow& state) {
  if (fd_ < 0) return;
  char bytes[kMarkBytes] = {};
  std::memcpy(bytes, state.store_id.data(), std::min(kIdBytes, state.store_id.size()));
  std::memcpy(bytes + kIdBytes, &state.log_end, sizeof(int64_t));
  std::memcpy(bytes + kIdBytes + sizeof(int64_t), &state.commits, sizeof(int64_t));
  std::memcpy(bytes + kMarkBytes - 16, Checksum(state).data(), 16);
  if (pwrite(fd_, bytes, kMarkBytes, 0) != static_cast<ssize_t>(kMarkBytes)) return;
}

}  // namespace overtone
