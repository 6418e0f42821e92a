// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/closure_messages.h"

#include "overtone/proto/conversion/proto_time.h"
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

v1::RegistrationFigures ToProto(const RegistrationFigures& figures) {
  v1::RegistrationFigures message;
  message.set_overlap(figures.overlap);
  message.set_overlap_threshold(figures.overlap_threshold);
  message.set_residual_m(figures.residual_m);
  message.set_residual_limit_m(figures.residual_limit_m);
  message.set_open_directions(figures.open_directions);
  message.set_converged(figures.converged);
  return message;
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
    *message.mutable_registration() = ToProto(*candidate.registration);
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

v1::Revision ToProto(const RevisionRecord& record) {
  v1::Revision message;
  message.set_revision(record.revision);
  message.set_map_epoch(record.map_epoch);
  *message.mutable_published() = ToProto(record.made);
  message.set_missions(record.missions);
  message.set_anchored_missions(record.anchored_missions);
  message.set_components(record.components);
  message.set_keyframes(record.keyframes);
  *message.mutable_verdicts() = ToProto(record.verdicts);
  message.mutable_accepted()->Add(record.accepted.begin(), record.accepted.end());
  message.mutable_dropped()->Add(record.dropped.begin(), record.dropped.end());
  message.set_cost_before(record.cost_before);
  message.set_cost_after(record.cost_after);
  message.set_mean_move_m(record.mean_move_m);
  message.set_largest_move_m(record.largest_move_m);
  message.set_optimisation_s(record.optimisation_s);
  return message;
}

ClosureVerdict FromProto(v1::LoopClosureVerdict verdict) {
  for (const ClosureVerdict known : AllClosureVerdicts()) {
    if (ToProto(known) == verdict) return known;
  }
  return ClosureVerdict::kPending;
}

LoopEvidence FromProto(v1::LoopClosureProposer proposer) {
  for (const LoopEvidence known : {LoopEvidence::kRobotScore, LoopEvidence::kScanContext}) {
    if (ToProto(known) == proposer) return known;
  }
  return LoopEvidence::kRobot;
}

RegistrationFigures FromProto(const v1::RegistrationFigures& message) {
  RegistrationFigures figures;
  figures.converged = message.converged();
  figures.overlap = message.overlap();
  figures.overlap_threshold = message.overlap_threshold();
  figures.residual_m = message.residual_m();
  figures.residual_limit_m = message.residual_limit_m();
  figures.open_directions = message.open_directions();
  return figures;
}

RevisionRecord FromProto(const v1::Revision& message) {
  RevisionRecord record;
  record.revision = message.revision();
  record.map_epoch = message.map_epoch();
  record.made = absl::FromUnixMicros(1'000'000 * message.published().seconds() +
                                     message.published().nanos() / 1000);
  record.missions = message.missions();
  record.anchored_missions = message.anchored_missions();
  record.components = message.components();
  record.keyframes = message.keyframes();
  for (const v1::VerdictCount& count : message.verdicts()) {
    record.verdicts[FromProto(count.verdict())] = count.count();
  }
  record.accepted.assign(message.accepted().begin(), message.accepted().end());
  record.dropped.assign(message.dropped().begin(), message.dropped().end());
  record.cost_before = message.cost_before();
  record.cost_after = message.cost_after();
  record.mean_move_m = message.mean_move_m();
  record.largest_move_m = message.largest_move_m();
  record.optimisation_s = message.optimisation_s();
  return record;
}

}  // namespace overtone
