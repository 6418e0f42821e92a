// SPDX-License-Identifier: Apache-2.0
// One map and what keeps it going: its store, its mapping thread and its publisher.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_HOSTED_MAP_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_HOSTED_MAP_H_

#include <memory>
#include <string>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "overtone/core/mapping/map_snapshot.h"
#include "overtone/services/mapping_server/graph_publisher.h"
#include "overtone/services/mapping_server/mapping_pipeline.h"
#include "overtone/services/mapping_server/server_options.h"
#include "overtone/services/mapping_server/submap_store.h"

namespace overtone {

// Thread-safe. Must not be destroyed on one of its own threads.
class HostedMap {
 public:
  HostedMap(std::string id, const ServerOptions& options);

  const std::string& id() const { return id_; }
  // A map that starts empty starts a new epoch, so that readers of an earlier one with the same id
  // notice: the microseconds since 1970.
  uint64_t epoch() const { return epoch_; }
  SubmapStore& store() { return *store_; }
  const SubmapStore& store() const { return *store_; }
  GraphPublisher& publisher() { return publisher_; }

  struct Published {
    std::shared_ptr<const MapSnapshot> snapshot;  // never null; empty, revision 0, before the first
    absl::Time time = absl::InfinitePast();
  };
  Published published() const;

 private:
  void OnSnapshot(std::shared_ptr<const MapSnapshot> snapshot);

  const std::string id_;
  const uint64_t epoch_;
  mutable absl::Mutex mutex_;
  Published published_ ABSL_GUARDED_BY(mutex_);
  // Each feeds the one above it, and is destroyed before it.
  GraphPublisher publisher_;
  MappingPipeline pipeline_;
  std::unique_ptr<SubmapStore> store_;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_HOSTED_MAP_H_
