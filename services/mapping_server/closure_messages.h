// SPDX-License-Identifier: Apache-2.0
// Loop closures and revisions as operators see them, and as they are stored.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_CLOSURE_MESSAGES_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_CLOSURE_MESSAGES_H_

#include <map>

#include "overtone/core/mapping/loop_closure.h"
#include "overtone/core/mapping/revision_history.h"
#include "overtone/v1/map_admin_service.pb.h"

namespace overtone {

v1::LoopClosureVerdict ToProto(ClosureVerdict verdict);
v1::LoopClosureProposer ToProto(LoopEvidence proposer);
v1::RegistrationFigures ToProto(const RegistrationFigures& figures);
v1::LoopClosureStatus ToProto(const ClosureRecord& record);
google::protobuf::RepeatedPtrField<v1::VerdictCount> ToProto(
    const std::map<ClosureVerdict, int64_t>& verdicts);

v1::Revision ToProto(const RevisionRecord& record);

// Back again. What this version does not know becomes pending and the robot's.
ClosureVerdict FromProto(v1::LoopClosureVerdict verdict);
LoopEvidence FromProto(v1::LoopClosureProposer proposer);
RegistrationFigures FromProto(const v1::RegistrationFigures& message);
RevisionRecord FromProto(const v1::Revision& message);

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_CLOSURE_MESSAGES_H_
