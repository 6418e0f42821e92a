// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/upload_sessions.h"

#include <vector>

namespace overtone {

absl::Status UploadSessions::Open(const std::string& map, const MissionId& mission,
                                  const std::shared_ptr<UploadStream>& stream) {
  std::shared_ptr<UploadStream> older = stream;
  {
    absl::MutexLock lock(&mutex_);
    if (stopping_) return absl::UnavailableError("the server is shutting down");
    std::swap(streams_[{map, mission}], older);
  }
  if (older != nullptr) {
    older->End(absl::AbortedError("a newer upload stream of this mission took over"));
  }
  return absl::OkStatus();
}

void UploadSessions::Close(const std::string& map, const MissionId& mission,
                           const UploadStream* stream) {
  absl::MutexLock lock(&mutex_);
  const auto it = streams_.find({map, mission});
  if (it != streams_.end() && it->second.get() == stream) streams_.erase(it);
}

void UploadSessions::End(const std::string& map, const absl::Status& status) {
  std::vector<std::shared_ptr<UploadStream>> ending;
  {
    absl::MutexLock lock(&mutex_);
    for (auto it = streams_.lower_bound({map, MissionId{}});
         it != streams_.end() && it->first.first == map;) {
      ending.push_back(std::move(it->second));
      it = streams_.erase(it);
    }
  }
  for (const std::shared_ptr<UploadStream>& stream : ending) stream->End(status);
}

bool UploadSessions::IsOpen(const std::string& map, const std::string& robot) const {
  absl::MutexLock lock(&mutex_);
  const auto first = streams_.lower_bound({map, MissionId{robot, ""}});
  return first != streams_.end() && first->first.first == map && first->first.second.robot == robot;
}

void UploadSessions::Stop() {
  std::map<Key, std::shared_ptr<UploadStream>> streams;
  {
    absl::MutexLock lock(&mutex_);
    stopping_ = true;
    streams.swap(streams_);
  }
  for (const auto& [key, stream] : streams) {
    stream->Drain(absl::UnavailableError("the server is shutting down"));
  }
}

}  // namespace overtone
