// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_MAP_REGISTRY_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_MAP_REGISTRY_H_

#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "overtone/services/mapping_server/data_directory.h"
#include "overtone/services/mapping_server/hosted_map.h"
#include "overtone/services/mapping_server/server_options.h"
#include "overtone/services/mapping_server/upload_sessions.h"
#include "overtone/services/mapping_server/worker_pool.h"

namespace overtone {

// The server's maps. Thread-safe. A map comes into being with its first submap and is there again
// after a restart; one that is only watched or about to get its first submap exists as long as
// somebody holds it.
class MapRegistry {
 public:
  explicit MapRegistry(const ServerOptions& options);
  // Waits until every map is closed: nobody holds one any more.
  ~MapRegistry();

  // Opens the data directory and all maps in it. An error names what is wrong with the directory; a
  // map that cannot be opened is logged, and its files are left alone.
  absl::Status Open();

  // InvalidArgument: not an id. NotFound: no such map. Unavailable: being changed as a whole.
  absl::StatusOr<std::shared_ptr<HostedMap>> Find(const std::string& id) const;

  // The map of that name, or a new one that nobody else sees before Keep. ResourceExhausted: too
  // many maps, or no room on disk. Unavailable: shutting down, or being changed as a whole.
  absl::StatusOr<std::shared_ptr<HostedMap>> Acquire(const std::string& id);

  // From now on the map stays; but not after Stop.
  void Keep(const std::shared_ptr<HostedMap>& map);

  const DataDirectory& directory() const { return directory_; }

  // By id.
  std::vector<std::shared_ptr<HostedMap>> List() const;

  // Changes a map as a whole: ends its readers and uploads, waits until nobody holds it any more,
  // and calls `change` with the path of its closed store; then opens it again with a new epoch, if
  // the store is still there. The caller holds no map, and is on no thread of one. A map that could
  // not be opened is one too. NotFound: no such map (for kChange). AlreadyExists: there is one (for
  // kCreate). ResourceExhausted: too many maps. An error of `change` leaves what it left.
  enum class Existing { kChange, kCreate, kEither };
  absl::Status Rebuild(const std::string& id, Existing existing, UploadSessions* sessions,
                       const std::function<absl::Status(const std::string& path)>& change);

  // Ends every reader of every map with UNAVAILABLE; no map is acquired afterwards.
  void Stop();

 private:
  // Its end comes on a thread of the registry's own: a map must not end on one of its own threads,
  // and whoever lets go of it last may be there.
  std::shared_ptr<HostedMap> Share(std::unique_ptr<HostedMap> map);
  absl::StatusOr<std::shared_ptr<HostedMap>> OpenMap(const std::string& id, HostedMap::Epoch epoch);
  absl::Status CheckAvailable(const std::string& id) const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // For Rebuild: from now on nobody else gets the map. Null when nobody holds it.
  absl::StatusOr<std::shared_ptr<HostedMap>> TakeAway(const std::string& id, Existing existing);
  void AwaitClosed(const std::string& id);
  absl::Status Reopen(const std::string& id);

  const ServerOptions options_;
  DataDirectory directory_;
  mutable absl::Mutex mutex_;
  std::map<std::string, std::shared_ptr<HostedMap>> maps_ ABSL_GUARDED_BY(mutex_);
  std::map<std::string, std::weak_ptr<HostedMap>> waiting_ ABSL_GUARDED_BY(mutex_);
  std::multiset<std::string> open_ ABSL_GUARDED_BY(mutex_);  // ids of all that exist
  std::set<std::string> opening_ ABSL_GUARDED_BY(mutex_);
  std::set<std::string> rebuilding_ ABSL_GUARDED_BY(mutex_);
  bool stopping_ ABSL_GUARDED_BY(mutex_) = false;
  WorkerPool closer_;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_MAP_REGISTRY_H_
