// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_QUOTA_STREAM_QUOTA_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_QUOTA_STREAM_QUOTA_H_

#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "absl/time/time.h"
#include "overtone/services/mapping_server/quota/robot_quotas.h"

namespace overtone {

// One stream's share of its robot's quota. `quotas` outlives it. Not thread-safe.
class StreamQuota {
 public:
  // `peer`: of quota_subject.h.
  StreamQuota(RobotQuotas* quotas, std::string peer) : quotas_(quotas), peer_(std::move(peer)) {}

  // Before all else. ResourceExhausted: the peer has too many streams open.
  absl::Status Open() { return Take(peer_); }
  // The peer has said who it is: from now on its stream is the robot's. As Open.
  absl::Status SetRobot(absl::string_view robot);

  // Once it is open: a message was read. The result: how long to read no other.
  absl::Duration Charge(int64_t bytes) { return quotas_->Charge(*share_, bytes); }

  // Whose stream it is: the certificate's robot, or the one it claims to be where there is none;
  // empty: no robot's.
  std::string RobotName(absl::string_view claimed) const;

  void Close() { share_.reset(); }

 private:
  absl::Status Take(const std::string& who);

  RobotQuotas* quotas_;
  std::string peer_;
  std::shared_ptr<const std::string> share_;  // who; gives the stream back when it goes
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_QUOTA_STREAM_QUOTA_H_
