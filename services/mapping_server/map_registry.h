// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_MAP_REGISTRY_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_MAP_REGISTRY_H_

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "overtone/services/mapping_server/disposal_thread.h"
#include "overtone/services/mapping_server/hosted_map.h"
#include "overtone/services/mapping_server/server_options.h"

namespace overtone {

// The server's maps. Thread-safe. A map comes into being with its first submap; one that is only
// watched or about to get its first submap exists as long as somebody holds it.
class MapRegistry {
 public:
  explicit MapRegistry(const ServerOptions& options);

  // InvalidArgument: not an id. NotFound: no such map.
  absl::StatusOr<std::shared_ptr<HostedMap>> Find(const std::string& id) const;

  // The map of that name, or a new one that nobody else sees before Keep. ResourceExhausted: too
  // many maps. Unavailable: shutting down.
  absl::StatusOr<std::shared_ptr<HostedMap>> Acquire(const std::string& id);

  // From now on the map stays.
  void Keep(const std::shared_ptr<HostedMap>& map);

  // By id.
  std::vector<std::shared_ptr<HostedMap>> List() const;

  // Ends every reader of every map with UNAVAILABLE; no map is acquired afterwards.
  void Stop();

 private:
  const ServerOptions options_;
  std::unique_ptr<DisposalThread> disposal_;  // destroyed last: maps go through it
  mutable absl::Mutex mutex_;
  std::map<std::string, std::shared_ptr<HostedMap>> maps_ ABSL_GUARDED_BY(mutex_);
  std::map<std::string, std::weak_ptr<HostedMap>> waiting_ ABSL_GUARDED_BY(mutex_);
  bool stopping_ ABSL_GUARDED_BY(mutex_) = false;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_MAP_REGISTRY_H_
