// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/quota/stream_quota.h"

#include "absl/strings/strip.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/services/mapping_server/quota/quota_subject.h"

namespace overtone {

absl::Status StreamQuota::SetRobot(absl::string_view robot) {
  const std::string who = QuotaSubjectOfRobot(peer_, robot);
  return share_ != nullptr && *share_ == who ? absl::OkStatus() : Take(who);
}

std::string StreamQuota::RobotName(absl::string_view claimed) const {
  const std::string who = QuotaSubjectOfRobot(peer_, claimed);
  absl::string_view name = who;
  return absl::ConsumePrefix(&name, "robot/") ? std::string(name) : "";
}

absl::Status StreamQuota::Take(const std::string& who) {
  ASSIGN_OR_RETURN(share_, quotas_->OpenStream(who));
  return absl::OkStatus();
}

}  // namespace overtone
