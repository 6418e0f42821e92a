// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_QUOTA_QUOTA_OPTIONS_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_QUOTA_QUOTA_OPTIONS_H_

#include <cstdint>

#include "absl/status/status.h"

namespace overtone {

// What one robot may take of the server, so that it slows itself and not its neighbours. 0: no
// limit. What a map may hold is in ServerLimits.
struct QuotaOptions {
  // Uploads and watches open at once. A robot needs two, one more for each mission that it still
  // has something of, and after a lost link some that only keepalive will end.
  int max_streams = 64;
  // Messages on all its uploads: a submap every second with a cloud for every keyframe are about
  // ten; the rest is for what it kept while the link was down. Beyond it the robot is not read
  // until it has fallen below again.
  double max_messages_per_s = 200;
  // How many may come at once after a quiet time: a second's worth. More is a jolt to its
  // neighbours.
  double messages_burst = 200;
  // The same in bytes: what a good radio link brings.
  double max_bytes_per_s = 8 << 20;
  double bytes_burst = 8 << 20;
  // Calls: GetGraph, GetUploadState, AddLoopClosures, GetServerInfo; opening a stream is one.
  // Beyond it: RESOURCE_EXHAUSTED with the delay after which one goes through.
  double max_calls_per_s = 50;
  double calls_burst = 200;

  absl::Status Validate() const;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_QUOTA_QUOTA_OPTIONS_H_
