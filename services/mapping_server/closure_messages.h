// SPDX-License-Identifier: Apache-2.0
// Loop closures as operators see them.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_CLOSURE_MESSAGES_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_CLOSURE_MESSAGES_H_

#include <map>

#include "overtone/core/mapping/loop_closure.h"
#include "overtone/v1/map_admin_service.pb.h"

namespace overtone {

v1::LoopClosureVerdict ToProto(ClosureVerdict verdict);
v1::LoopClosureProposer ToProto(LoopEvidence proposer);
v1::LoopClosureStatus ToProto(const ClosureRecord& record);
google::protobuf::RepeatedPtrField<v1::VerdictCount> ToProto(
    const std::map<ClosureVerdict, int64_t>& verdicts);

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_CLOSURE_MESSAGES_H_
