// SPDX-License-Identifier: Apache-2.0
// Measures a loop candidate by registering the clouds of its two ends.
#ifndef OVERTONE_CORE_MAPPING_CLOUD_VERIFIER_H_
#define OVERTONE_CORE_MAPPING_CLOUD_VERIFIER_H_

#include <memory>
#include <utility>

#include "absl/base/thread_annotations.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "overtone/core/common/lru_cache.h"
#include "overtone/core/place_recognition/loop_detection.h"
#include "overtone/core/registration/coarse_to_fine.h"

namespace overtone {

// What the registration of two clouds must give.
struct CloudRequirements {
  double min_overlap = 0.6;  // share of the points that have a counterpart
  double max_residual_m = 0.15;
};

struct CloudVerifierOptions {
  CoarseToFineOptions registration;
  CloudRequirements required;
  // Planar lasers: rooms and corridors, few points, and many places of nearly the same outline.
  CoarseToFineOptions planar_registration = PlanarRegistration();
  CloudRequirements planar_required = {0.7, 0.08};
  // Further apart, two keyframes do not see the same: the registration has slipped.
  double max_translation_m = 15;

  absl::Status Validate() const;
  // IndoorLaserOptions, from the guess and turned around: half a scan often looks the same both
  // ways.
  static CoarseToFineOptions PlanarRegistration();
};

// Thread-safe; keeps the pyramids of the views it saw last.
class CloudVerifier final : public LoopVerifier {
 public:
  // `options` must be valid.
  CloudVerifier(const CloudVerifierOptions& options, size_t max_pyramids)
      : options_(options), pyramids_(max_pyramids) {}

  // InvalidArgument: a cloud has too few points, or one is planar and the other is not.
  absl::Status Verify(const PlaceView& from, const PlaceView& to,
                      LoopCandidate& candidate) const override;

 private:
  absl::StatusOr<std::shared_ptr<const RegistrationPyramid>> Pyramid(const PlaceView& view) const;
  const CoarseToFineOptions& OptionsFor(bool planar) const;

  const CloudVerifierOptions options_;
  mutable absl::Mutex mutex_;
  // By keyframe, and whether it is its own scan alone.
  mutable LruCache<std::pair<NodeId, bool>, RegistrationPyramid> pyramids_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace overtone

#endif  // OVERTONE_CORE_MAPPING_CLOUD_VERIFIER_H_
