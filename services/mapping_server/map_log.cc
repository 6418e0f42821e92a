// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/map_log.h"

#include <set>
#include <utility>

#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/geometry_conversion.h"
#include "overtone/proto/conversion/id_conversion.h"
#include "overtone/proto/conversion/sighting_conversion.h"
#include "overtone/services/mapping_server/closure_messages.h"

namespace overtone {
namespace {

// What a registration gave may lie beyond the limits that robots have to keep to.
absl::StatusOr<Matrix6d> ReadCovariance(const v1::PoseCovariance& message) {
  if (message.upper_triangle_size() != 21) return absl::DataLossError("covariance: not 21 numbers");
  Matrix6d covariance;
  auto value = message.upper_triangle().begin();
  for (int row = 0; row < 6; ++row) {
    for (int column = row; column < 6; ++column) {
      covariance(row, column) = covariance(column, row) = *value++;
    }
  }
  return covariance;
}

storage::v1::Candidate ToStorage(const LoopCandidate& candidate) {
  storage::v1::Candidate message;
  *message.mutable_from() = ToProto(candidate.from);
  *message.mutable_to() = ToProto(candidate.to);
  *message.mutable_from_tform_to() = ToProto(candidate.from_tform_to);
  *message.mutable_covariance() = ToProto(candidate.covariance);
  message.set_proposer(ToProto(candidate.proposer));
  message.set_score(candidate.score);
  message.set_score_threshold(candidate.score_threshold);
  message.set_measured(candidate.measured);
  if (candidate.registration.has_value()) {
    *message.mutable_registration() = ToProto(*candidate.registration);
  }
  return message;
}

absl::StatusOr<LoopCandidate> FromStorage(const storage::v1::Candidate& message) {
  LoopCandidate candidate;
  ASSIGN_OR_RETURN(candidate.from, FromProto(message.from()));
  ASSIGN_OR_RETURN(candidate.to, FromProto(message.to()));
  ASSIGN_OR_RETURN(candidate.from_tform_to, FromProto(message.from_tform_to()));
  ASSIGN_OR_RETURN(candidate.covariance, ReadCovariance(message.covariance()));
  candidate.proposer = FromProto(message.proposer());
  candidate.score = message.score();
  candidate.score_threshold = message.score_threshold();
  candidate.measured = message.measured();
  if (message.has_registration()) candidate.registration = FromProto(message.registration());
  return candidate;
}

storage::v1::Search ToStorage(const SearchResult& search) {
  storage::v1::Search message;
  *message.mutable_node() = ToProto(search.node);
  for (const LoopCandidate& candidate : search.candidates) {
    *message.add_candidates() = ToStorage(candidate);
  }
  return message;
}

absl::StatusOr<SearchResult> FromStorage(const storage::v1::Search& message) {
  SearchResult search;
  ASSIGN_OR_RETURN(search.node, FromProto(message.node()));
  for (const storage::v1::Candidate& candidate : message.candidates()) {
    ASSIGN_OR_RETURN(LoopCandidate found, FromStorage(candidate));
    search.candidates.push_back(std::move(found));
  }
  return search;
}

storage::v1::Motion ToStorage(const RefinedMotion& motion) {
  storage::v1::Motion message;
  *message.mutable_node() = ToProto(motion.measurement.to);
  *message.mutable_previous_tform_this() = ToProto(motion.measurement.previous_from_this);
  *message.mutable_covariance() = ToProto(motion.measurement.covariance);
  message.set_determined(motion.determined);
  return message;
}

absl::StatusOr<RefinedMotion> FromStorage(const storage::v1::Motion& message) {
  RefinedMotion motion;
  ASSIGN_OR_RETURN(motion.measurement.to, FromProto(message.node()));
  ASSIGN_OR_RETURN(motion.measurement.previous_from_this, FromProto(message.previous_tform_this()));
  ASSIGN_OR_RETURN(motion.measurement.covariance, ReadCovariance(message.covariance()));
  motion.determined = message.determined();
  return motion;
}

// What a finding says, and the missions without which it says nothing.
struct Writer {
  storage::v1::Finding message;
  std::set<MissionId> missions;

  void operator()(const SearchResult& search) {
    *message.mutable_search() = ToStorage(search);
    missions.insert(search.node.mission);
  }
  void operator()(const ScoredCandidate& pair) {
    *message.mutable_scored_pair() = ToProto(pair);
    missions = {pair.from.mission, pair.to.mission};
  }
  void operator()(const LoopCandidate& candidate) {
    *message.mutable_measured_pair() = ToStorage(candidate);
    missions = {candidate.from.mission, candidate.to.mission};
  }
  void operator()(const MapDecisions& decisions) {
    message.mutable_decisions()->set_map_epoch(decisions.map_epoch);
    ToStorage(decisions, message.mutable_decisions()->mutable_decisions());
  }
  void operator()(const RefinedMotion& motion) {
    *message.mutable_motion() = ToStorage(motion);
    missions = {motion.measurement.to.mission};
  }
};

}  // namespace

void ToStorage(const MapDecisions& decisions,
               google::protobuf::RepeatedPtrField<storage::v1::Decision>* messages) {
  for (const MapDecisions::Decision& decision : decisions.decisions) {
    storage::v1::Decision& message = *messages->Add();
    message.set_id(decision.id);
    message.set_kind(static_cast<storage::v1::Decision::Kind>(decision.decision));
  }
}

std::vector<MapDecisions::Decision> FromStorage(
    const google::protobuf::RepeatedPtrField<storage::v1::Decision>& messages) {
  std::vector<MapDecisions::Decision> decisions;
  for (const storage::v1::Decision& message : messages) {
    const bool known = storage::v1::Decision::Kind_IsValid(message.kind());
    decisions.push_back({message.id(), known ? static_cast<ClosureDecision>(message.kind())
                                             : ClosureDecision::kNone});
  }
  return decisions;
}

FindingRecord ToRecord(const Finding& finding) {
  Writer writer;
  std::visit(writer, finding);
  return {writer.message.SerializeAsString(), {writer.missions.begin(), writer.missions.end()}};
}

absl::StatusOr<Finding> ParseFinding(const std::string& bytes) {
  storage::v1::Finding message;
  if (message.ParseFromString(bytes)) {
    switch (message.finding_case()) {
      case storage::v1::Finding::kSearch:
        return FromStorage(message.search());
      case storage::v1::Finding::kScoredPair:
        return FromProto(message.scored_pair());
      case storage::v1::Finding::kMeasuredPair:
        return FromStorage(message.measured_pair());
      case storage::v1::Finding::kDecisions:
        return MapDecisions{message.decisions().map_epoch(),
                            FromStorage(message.decisions().decisions())};
      case storage::v1::Finding::kMotion:
        return FromStorage(message.motion());
      case storage::v1::Finding::FINDING_NOT_SET:
        break;
    }
  }
  return absl::DataLossError("not a finding that this server knows");
}

}  // namespace overtone
