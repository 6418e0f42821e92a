// SPDX-License-Identifier: Apache-2.0
// The upload streams that are open: one for each mission, the newest wins.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_UPLOAD_SESSIONS_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_UPLOAD_SESSIONS_H_

#include <map>
#include <memory>
#include <string>
#include <utility>

#include "absl/base/thread_annotations.h"
#include "absl/status/status.h"
#include "absl/synchronization/mutex.h"
#include "overtone/core/common/ids.h"

namespace overtone {

class UploadStream {
 public:
  virtual ~UploadStream() = default;
  // At once.
  virtual void End(const absl::Status& status) = 0;
  // When all that was read from it is answered; no more is read.
  virtual void Drain(const absl::Status& status) = 0;
};

// Thread-safe.
class UploadSessions {
 public:
  // A robot that lost its link comes back before the server has noticed: its older stream of the
  // same mission, if any, ends with ABORTED. Unavailable: shutting down.
  absl::Status Open(const std::string& map, const MissionId& mission,
                    const std::shared_ptr<UploadStream>& stream);
  // Nothing happens when a newer stream took its place.
  void Close(const std::string& map, const MissionId& mission, const UploadStream* stream);

  // Ends all of the map's.
  void End(const std::string& map, const absl::Status& status);

  bool IsOpen(const std::string& map, const std::string& robot) const;

  // Drains all with UNAVAILABLE and opens no others.
  void Stop();

 private:
  using Key = std::pair<std::string, MissionId>;

  mutable absl::Mutex mutex_;
  std::map<Key, std::shared_ptr<UploadStream>> streams_ ABSL_GUARDED_BY(mutex_);
  bool stopping_ ABSL_GUARDED_BY(mutex_) = false;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_UPLOAD_SESSIONS_H_
