// SPDX-License-Identifier: Apache-2.0
// Looks for loops in the clouds of one map, on threads of its own: so it holds up neither uploads
// nor the mapping thread.
//   cloud -> view (gathered over a few keyframes) -> proposer -> candidates -> verifier -> the map
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_LOOP_DETECTOR_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_LOOP_DETECTOR_H_

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/container/flat_hash_set.h"
#include "absl/status/status.h"
#include "absl/synchronization/mutex.h"
#include "overtone/core/graph/submap.h"
#include "overtone/core/mapping/cloud_verifier.h"
#include "overtone/core/mapping/multi_robot_map.h"
#include "overtone/core/place_recognition/loop_detection.h"
#include "overtone/core/place_recognition/scan_context_proposer.h"
#include "overtone/services/mapping_server/cloud_library.h"
#include "overtone/services/mapping_server/worker_pool.h"

namespace overtone {

struct LoopDetectorOptions {
  // False: clouds are stored, and nobody looks for loops in them.
  bool enabled = true;
  // Side by side; each registration takes one.
  int num_threads = 2;
  // Where the sensor does not see all around, a view gathers the clouds of the keyframes so far
  // back, metres: one scan alone sees too little.
  double gather_length_m = 4;
  // Register each scan of a planar laser against what was seen just before it: wheel odometry is
  // much the coarser of the two.
  bool refine_planar_motion = true;
  // Views and their registration pyramids kept ready; beyond, they are made again.
  int max_views = 256;
  ScanContextProposerOptions proposer;
  CloudVerifierOptions verifier;

  absl::Status Validate() const;
};

// The places that look like a keyframe, looked at closer.
struct SearchResult {
  NodeId node;
  std::vector<LoopCandidate> candidates;
};

// A motion between two keyframes, measured by their clouds.
struct RefinedMotion {
  MotionMeasurement measurement;
  bool determined = false;  // in all directions
};

// Thread-safe.
class LoopDetector {
 public:
  struct Sink {
    std::function<void(SearchResult)> on_search;          // once for each cloud
    std::function<void(RefinedMotion)> on_motion;         // before on_search of its keyframe
    std::function<void(LoopCandidate)> on_measured_pair;  // of a robot's scored ones
    std::function<void(ScoredCandidate)> on_scored_pair;  // that has no clouds to look at
  };

  // The sink is called from its threads, from AddSubmap, CloudGone and EndReplay.
  LoopDetector(const LoopDetectorOptions& options, CloudLibrary::BlobSource source, Sink sink);

  // In the order in which the map gets them; clouds after their submap.
  void AddSubmap(const MissionId& mission, const Submap& submap);
  void AddCloud(const NodeId& node, const std::string& sha256);
  // An announced cloud will not come: scored pairs that waited for it go on without.
  void CloudGone(const NodeId& node);

  // After a restart what was there before comes first: what was found then (Note...) is not looked
  // for again, and until EndReplay nothing is looked for at all.
  void BeginReplay();
  void NoteSearch(const NodeId& node);
  void NoteMotion(const RefinedMotion& motion);
  void NotePair(const NodeId& from, const NodeId& to);
  void EndReplay();

  // Clouds and candidates that are still to be looked at.
  int64_t backlog() const {
    const int64_t to_describe = describer_.backlog();  // first: what it leaves is in the pool then
    return to_describe + pool_.backlog();
  }

  // Of all keyframes that have them, also where nobody looks for loops.
  const CloudLibrary& clouds() const { return library_; }

  // The place that looks most like this one. Absent: no cloud here, or none elsewhere.
  std::optional<LoopCandidate> MostSimilar(const NodeId& node) const;

 private:
  // A search whose candidates are still being looked at.
  struct Search;

  void PostDescribe(const NodeId& node);
  void Describe(const NodeId& node);
  absl::Status RefineMotion(const NodeId& node);
  absl::Status Verify(LoopCandidate& candidate);
  void VerifyOfSearch(Search& search, LoopCandidate candidate);
  void VerifyPair(LoopCandidate candidate);
  // Sends scored pairs on their way: whose clouds are there, to the verifier; one of whose clouds
  // will not come, as they are. The others wait.
  void SortWaiting();

  const LoopDetectorOptions options_;
  const Sink sink_;
  const std::unique_ptr<const LoopVerifier> verifier_;
  CloudLibrary library_;
  mutable absl::Mutex mutex_;
  const std::unique_ptr<LoopProposer> proposer_ ABSL_PT_GUARDED_BY(mutex_);
  std::vector<ScoredCandidate> waiting_ ABSL_GUARDED_BY(mutex_);
  bool replaying_ ABSL_GUARDED_BY(mutex_) = false;
  std::vector<NodeId> replayed_clouds_ ABSL_GUARDED_BY(mutex_);
  absl::flat_hash_set<NodeId> searched_ ABSL_GUARDED_BY(mutex_);  // before the restart
  absl::flat_hash_set<NodeId> refined_ ABSL_GUARDED_BY(mutex_);   // likewise
  WorkerPool pool_;       // verifies; its tasks use everything above
  WorkerPool describer_;  // one thread: clouds are described in the order in which they come
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_LOOP_DETECTOR_H_
