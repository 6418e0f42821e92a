// SPDX-License-Identifier: Apache-2.0
// Single messages of the API as JSON for the page.
#ifndef OVERTONE_SERVICES_DASHBOARD_PROTO_JSON_H_
#define OVERTONE_SERVICES_DASHBOARD_PROTO_JSON_H_

#include "google/protobuf/repeated_field.h"
#include "google/protobuf/timestamp.pb.h"
#include "nlohmann/json.hpp"
#include "overtone/v1/map_admin_service.pb.h"

namespace overtone {

// Null where the message is not set.
nlohmann::json Milliseconds(bool is_set, const google::protobuf::Timestamp& time);
nlohmann::json ToJson(const v1::Pose& pose);  // {"p": [x, y, z], "q": [x, y, z, w]}
nlohmann::json ToJson(const v1::LinkReport& link);
nlohmann::json ToJson(const v1::ComparisonReport& comparison);  // without its columns
nlohmann::json ToJson(const v1::LoopClosureStatus& closure);
nlohmann::json ToJson(const v1::Revision& revision);
nlohmann::json ToJson(const google::protobuf::RepeatedPtrField<v1::VerdictCount>& counts);

}  // namespace overtone

#endif  // OVERTONE_SERVICES_DASHBOARD_PROTO_JSON_H_
