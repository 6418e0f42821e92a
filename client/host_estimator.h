// SPDX-License-Identifier: Apache-2.0
// The one interface an integrator implements: the client's view of the robot's own estimator.
#ifndef OVERTONE_CLIENT_HOST_ESTIMATOR_H_
#define OVERTONE_CLIENT_HOST_ESTIMATOR_H_

#include <cstdint>
#include <vector>

#include "absl/status/status.h"
#include "overtone/core/synchronization/constraint.h"
#include "overtone/core/synchronization/node_association.h"

namespace overtone {

using OnboardPose = NodePose;  // one keyframe as the onboard estimator sees it now

// How it stands with the server.
enum class LinkState {
  kConnecting,  // no server yet, or reconnecting
  kLive,        // frames or heartbeats arrive
  kRefused,     // the server answers, but not to us: identity or access rules; the log says why
  kStale,       // nothing heard for MappingClientOptions::stale_after
};

// All calls come from one thread of the client's (the synchronisation thread), never two at once,
// and never from inside a call into MappingClient. An exception that leaves one of them is caught
// and logged, and the batch counts as refused.
class HostEstimator {
 public:
  virtual ~HostEstimator() = default;

  // The current estimate of every keyframe of this mission that the host still holds, index
  // increasing.
  virtual std::vector<OnboardPose> Trajectory() = 0;

  // Applies a batch at once. Not ok: the host could not; the client will offer it anew after the
  // next comparison.
  virtual absl::Status ApplyConstraints(const ConstraintBatch& batch) = 0;

  // Whenever it changes.
  virtual void OnLinkState(LinkState /*state*/) {}

  // The server refused a submap for good (InvalidArgument, AlreadyExists, ...): the reason, once
  // for each. A submap that follows a refused one cannot be stored without it and is refused too;
  // AddSubmap then expects the first of them anew. (After AlreadyExists the mission goes on: the
  // server holds that sequence, with other content.) With an outbox on disk it may be told again
  // after a restart that came in between.
  //
  // DataLoss: the server expects an earlier submap, which is not there any more: it lost it, or an
  // operator deleted the mission, or the outbox's file was damaged. `sequence` is the first that
  // waits; nothing is thrown away, but nothing goes up either unless the server finds what it
  // lost. Start a new mission. Told once.
  virtual void OnSubmapRejected(int64_t /*sequence*/, const absl::Status& /*reason*/) {}

  // Clouds that will never reach the map, `total` of this mission so far: the outbox was full, they
  // could not be encoded (not finite, too wide), or the server would not have them. Their keyframes
  // are not affected.
  virtual void OnCloudsDropped(int64_t /*total*/) {}

  // The server refused a batch of AddLoopClosures for good; none of it is kept.
  virtual void OnLoopClosuresRejected(const absl::Status& /*reason*/) {}
};

}  // namespace overtone

#endif  // OVERTONE_CLIENT_HOST_ESTIMATOR_H_
