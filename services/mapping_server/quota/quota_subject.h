// SPDX-License-Identifier: Apache-2.0
// Whose quota a call takes.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_QUOTA_QUOTA_SUBJECT_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_QUOTA_QUOTA_SUBJECT_H_

#include <string>

#include "absl/strings/string_view.h"
#include "grpcpp/grpcpp.h"
#include "overtone/services/mapping_server/security/access_control.h"

namespace overtone {

// "robot/anna" or "operator/olga" where a certificate says so; else the connection, e.g.
// "ipv4:10.0.0.3:50432".
std::string QuotaSubject(const grpc::CallbackServerContext& context, const AccessControl& access);

// "robot/anna" for a peer that is known by its connection only and says that it is anna; a name
// that is no id counts for nothing. `peer` comes from QuotaSubject.
std::string QuotaSubjectOfRobot(const std::string& peer, absl::string_view robot);

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_QUOTA_QUOTA_SUBJECT_H_
