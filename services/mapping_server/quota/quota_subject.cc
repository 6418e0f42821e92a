// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/quota/quota_subject.h"

#include "absl/status/statusor.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "overtone/core/common/ids.h"

namespace overtone {

std::string QuotaSubject(const grpc::CallbackServerContext& context, const AccessControl& access) {
  const absl::StatusOr<PeerIdentity> identity = access.Authenticate(PeerCertificateOf(context));
  return identity.ok() ? ToString(*identity) : context.peer();
}

std::string QuotaSubjectOfRobot(const std::string& peer, absl::string_view robot) {
  const bool identified = absl::StartsWith(peer, "robot/") || absl::StartsWith(peer, "operator/");
  if (identified) return peer;
  return ValidateId(robot, "robot").ok() ? absl::StrCat("robot/", robot) : peer;
}

}  // namespace overtone
