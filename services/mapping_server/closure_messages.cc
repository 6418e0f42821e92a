// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/closure_messages.h"

#include "overtone/proto/conversion/submap_conversion.h"

namespace overtone {

v1::LoopClosureVerdict ToProto(ClosureVerdict verdict) {
  switch (verdict) {
    case ClosureVerdict::kPending:
      return v1::LOOP_CLOSURE_VERDICT_PENDING;
    case ClosureVerdict::kAccepted:
      return v1::LOOP_CLOSURE_VERDICT_ACCEPTED;
    case ClosureVerdict::kDemotedByOptimiser:
      return v1::LOOP_CLOSURE_VERDICT_DEMOTED_BY_OPTIMISER;
    case ClosureVerdict::kQuarantined:
      return v1::LOOP_CLOSURE_VERDICT_QUARANTINED;
    case ClosureVerdict::kRejectedScore:
      return v1::LOOP_CLOSURE_VERDICT_REJECTED_SCORE;
    case ClosureVerdict::kRejectedOverlap:
      return v1::LOOP_CLOSURE_VERDICT_REJECTED_OVERLAP;
    case ClosureVerdict::kRejectedResidual:
      return v1::LOOP_CLOSURE_VERDICT_REJECTED_RESIDUAL;
    case ClosureVerdict::kRejectedDegenerate:
      return v1::LOOP_CLOSURE_VERDICT_REJECTED_DEGENERATE;
    case ClosureVerdict::kRejectedInconsistent:
      return v1::LOOP_CLOSURE_VERDICT_REJECTED_INCONSISTENT;
    case ClosureVerdict::kVetoedByOperator:
      return v1::LOOP_CLOSURE_VERDICT_VETOED_BY_OPERATOR;
    case ClosureVerdict::kForcedByOperator:
      return v1::LOOP_CLOSURE_VERDICT_FORCED_BY_OPERATOR;
  }
  return v1::LOOP_CLOSURE_VERDICT_UNSPECIFIED;
}

v1::LoopClosureProposer ToProto(LoopEvidence proposer) {
  switch (proposer) {
    case LoopEvidence::kRobot:
      return v1::LOOP_CLOSURE_PROPOSER_ROBOT;
    case LoopEvidence::kRobotScore:
      return v1::LOOP_CLOSURE_PROPOSER_ROBOT_SCORE;
    case LoopEvidence::kScanContext:
      return v1::LOOP_CLOSURE_PROPOSER_SCAN_CONTEXT;
  }
  return v1::LOOP_CLOSURE_PROPOSER_UNSPECIFIED;
}

v1::LoopClosureStatus ToProto(const ClosureRecord& record) {
  const LoopCandidate& candidate = record.candidate;
  v1::LoopClosureStatus message;
  *message.mutable_loop_closure() = ToProto(
      LoopClosure{candidate.from, candidate.to, candidate.from_tform_to, candidate.covariance});
  message.set_verdict(ToProto(record.verdict));
  message.set_weight(record.weight);
  message.set_chi_square(record.chi_square);
  message.set_id(record.id);
  message.set_proposer(ToProto(candidate.proposer));
  message.set_score(candidate.score);
  message.set_score_threshold(candidate.score_threshold);
  if (candidate.registration.has_value()) {
    const RegistrationFigures& figures = *candidate.registration;
    v1::RegistrationFigures& out = *message.mutable_registration();
    out.set_overlap(figures.overlap);
    out.set_overlap_threshold(figures.overlap_threshold);
    out.set_residual_m(figures.residual_m);
    out.set_residual_limit_m(figures.residual_limit_m);
    out.set_open_directions(figures.open_directions);
    out.set_converged(figures.converged);
  }
  message.set_reason(Reason(record));
  message.set_measured(candidate.measured);
  message.set_since_revision(record.since_revision);
  return message;
}

google::protobuf::RepeatedPtrField<v1::VerdictCount> ToProto(
    const std::map<ClosureVerdict, int64_t>& verdicts) {
  google::protobuf::RepeatedPtrField<v1::VerdictCount> messages;
  for (const auto& [verdict, count] : verdicts) {
    v1::VerdictCount& message = *messages.Add();
    message.set_verdict(ToProto(verdict));
    message.set_count(count);
  }
  return messages;
}

}  // namespace overtone
