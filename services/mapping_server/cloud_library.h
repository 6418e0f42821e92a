// SPDX-License-Identifier: Apache-2.0
// Which keyframes of a map have clouds, and the local maps made from these. The clouds themselves
// stay where they are stored: in memory there are only the views asked for last.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_CLOUD_LIBRARY_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_CLOUD_LIBRARY_H_

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "overtone/core/common/lru_cache.h"
#include "overtone/core/graph/submap.h"
#include "overtone/core/place_recognition/loop_detection.h"

namespace overtone {

// Thread-safe.
class CloudLibrary {
 public:
  // Gives an encoded cloud by its SHA-256; called from any thread, without locks.
  using BlobSource =
      std::function<absl::StatusOr<std::shared_ptr<const std::string>>(const std::string& sha256)>;

  // The view of a sensor that does not see all around gathers the clouds of the keyframes up to
  // gather_length_m before it. The `max_views` views asked for last are kept.
  CloudLibrary(double gather_length_m, size_t max_views, BlobSource source)
      : gather_length_m_(gather_length_m), source_(std::move(source)), views_(max_views) {}

  // Keyframes by odometry, and which of them will have a cloud.
  void AddSubmap(const MissionId& mission, const Submap& submap);
  void AddCloud(const NodeId& node, const std::string& sha256);
  // The cloud was announced, and will not come; should it do so after all, the better.
  void CloudGone(const NodeId& node);

  bool HasCloud(const NodeId& node) const;
  // It is there, or still to come.
  bool ExpectsCloud(const NodeId& node) const;

  // NotFound: no cloud of that keyframe. InvalidArgument: it cannot be decoded. Others
  // that cannot, or that the source does not give, are left out.
  absl::StatusOr<std::shared_ptr<const PlaceView>> View(const NodeId& node);
  // The keyframe's own cloud alone.
  absl::StatusOr<PlaceView> Scan(const NodeId& node) const;

  // The motion into a keyframe from the one before it, by which views made from now on are
  // gathered: odometry's until a finer one is set. Identity for a mission's first keyframe.
  Rigid3d MotionInto(const NodeId& node) const;
  void SetMotionInto(const NodeId& node, const Rigid3d& previous_from_this);

 private:
  struct KeyframeEntry {
    Rigid3d mission_from_body;   // odometry
    Rigid3d previous_from_this;  // finer, perhaps
    double travelled_m = 0;
    bool expects_cloud = false;
    std::string sha256;  // of its cloud; empty: none yet
  };
  struct Part {
    Rigid3d newest_from_this;
    std::string sha256;
  };

  KeyframeEntry* Find(const NodeId& node) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  const KeyframeEntry* Find(const NodeId& node) const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  absl::StatusOr<PointCloud> Load(const Part& part) const;
  PointCloud Gather(const std::vector<Part>& parts) const;
  // The node's own cloud first, then those of the keyframes before it.
  absl::StatusOr<std::vector<Part>> PartsOf(const NodeId& node, PlaceView* view) const;

  const double gather_length_m_;
  const BlobSource source_;
  mutable absl::Mutex mutex_;
  std::map<MissionId, std::vector<KeyframeEntry>> missions_ ABSL_GUARDED_BY(mutex_);
  LruCache<NodeId, PlaceView> views_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_CLOUD_LIBRARY_H_
