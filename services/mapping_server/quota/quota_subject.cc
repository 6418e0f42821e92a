// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/quota/quota_subject.h"

#include "absl/strings/str_cat.h"
#include "overtone/core/common/ids.h"

namespace overtone {

std::string QuotaSubject(const grpc::CallbackServerContext& context) { return context.peer(); }

std::string QuotaSubjectOfRobot(const std::string& peer, absl::string_view robot) {
  return ValidateId(robot, "robot").ok() ? absl::StrCat("robot/", robot) : peer;
}

}  // namespace overtone
