// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/closure_listing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/field_path.h"
#include "overtone/proto/conversion/id_conversion.h"
#include "overtone/proto/conversion/proto_time.h"
#include "overtone/services/mapping_server/closure_messages.h"
#include "overtone/services/mapping_server/pagination.h"

namespace overtone {
namespace {

constexpr double kDefaultRadiusM = 5;
constexpr size_t kMaxExplained = 100;
constexpr int kMaxListedIds = 100;

// The checked filter of a request.
struct Filter {
  v1::LoopClosureVerdict verdict = v1::LOOP_CLOSURE_VERDICT_UNSPECIFIED;
  v1::LoopClosureProposer proposer = v1::LOOP_CLOSURE_PROPOSER_UNSPECIFIED;
  std::string robot;                 // empty: any
  std::optional<MissionId> mission;  // absent: any

  bool Matches(const ClosureRecord& record) const {
    const MissionId& from = record.candidate.from.mission;
    const MissionId& to = record.candidate.to.mission;
    return (verdict == v1::LOOP_CLOSURE_VERDICT_UNSPECIFIED ||
            verdict == ToProto(record.verdict)) &&
           (proposer == v1::LOOP_CLOSURE_PROPOSER_UNSPECIFIED ||
            proposer == ToProto(record.candidate.proposer)) &&
           (robot.empty() || from.robot == robot || to.robot == robot) &&
           (!mission.has_value() || from == *mission || to == *mission);
  }
};

absl::StatusOr<Filter> ReadFilter(const v1::ListLoopClosuresRequest& request) {
  Filter filter;
  if (!v1::LoopClosureVerdict_IsValid(request.verdict())) {
    return InvalidField("verdict", absl::StrCat(request.verdict(), " is not a known one"));
  }
  if (!v1::LoopClosureProposer_IsValid(request.proposer())) {
    return InvalidField("proposer", absl::StrCat(request.proposer(), " is not a known one"));
  }
  if (!request.robot().empty()) RETURN_IF_ERROR(ValidateId(request.robot(), "robot"));
  if (request.has_mission()) {
    ASSIGN_OR_RETURN(filter.mission, AtField("mission", FromProto(request.mission())));
  }
  filter.verdict = request.verdict();
  filter.proposer = request.proposer();
  filter.robot = request.robot();
  return filter;
}

// Way along the mission, as optimised, at each keyframe.
std::vector<double> TravelledM(const SnapshotMission& mission) {
  std::vector<double> travelled_m(mission.map_from_body.size(), 0);
  for (size_t i = 1; i < travelled_m.size(); ++i) {
    travelled_m[i] =
        travelled_m[i - 1] +
        (mission.map_from_body[i].translation - mission.map_from_body[i - 1].translation).norm();
  }
  return travelled_m;
}

absl::StatusOr<const SnapshotMission*> FindMission(const MapSnapshot& snapshot,
                                                   const NodeId& node) {
  for (const SnapshotMission& mission : snapshot.missions) {
    if (mission.id != node.mission) continue;
    if (node.index < static_cast<int64_t>(mission.keyframes.size())) return &mission;
    return absl::NotFoundError(absl::StrCat("node: ", ToString(node.mission),
                                            " has keyframes 0 to ", mission.keyframes.size() - 1,
                                            " in revision ", snapshot.revision));
  }
  return absl::NotFoundError(absl::StrCat("node: no mission ", ToString(node.mission),
                                          " in revision ", snapshot.revision));
}

// Used ones first, then those that came furthest.
int Rank(ClosureVerdict verdict) {
  switch (verdict) {
    case ClosureVerdict::kForcedByOperator:
    case ClosureVerdict::kAccepted:
      return 0;
    case ClosureVerdict::kVetoedByOperator:
    case ClosureVerdict::kDemotedByOptimiser:
      return 1;
    case ClosureVerdict::kQuarantined:
    case ClosureVerdict::kPending:
      return 2;
    case ClosureVerdict::kRejectedInconsistent:
      return 3;
    default:
      return 4;
  }
}

std::string Name(const ClosureRecord& record) {
  return absl::StrCat(ToString(record.candidate.from), " and ", ToString(record.candidate.to));
}

std::string WhyNotProposed(const std::optional<LoopCandidate>& nearest) {
  if (!nearest.has_value()) {
    return "no cloud of this keyframe was looked at, or there is no other place to compare it with";
  }
  const std::string similar =
      absl::StrFormat("the place that looks most like it is %s, with similarity %.2f",
                      ToString(nearest->from), nearest->score);
  if (nearest->score < nearest->score_threshold) {
    return absl::StrFormat("%s; %.2f are needed", similar, nearest->score_threshold);
  }
  return absl::StrCat(similar,
                      ", enough; but the two clouds cannot be, or are still to be, compared");
}

std::string Explain(const NodeId& node, double radius_m,
                    const std::vector<const ClosureRecord*>& here,
                    const std::optional<LoopCandidate>& nearest) {
  if (here.empty()) {
    return absl::StrFormat("There is no loop within %g m of %s because nothing was proposed: %s.",
                           radius_m, ToString(node), WhyNotProposed(nearest));
  }
  const ClosureRecord& best = *here.front();
  if (InUse(best.verdict)) {
    const auto used = std::count_if(here.begin(), here.end(), [](const ClosureRecord* record) {
      return InUse(record->verdict);
    });
    return absl::StrFormat(
        "There %s in use within %g m of %s, such as that between %s: it %s.",
        used == 1 ? "is 1 loop closure" : absl::StrCat("are ", used, " loop closures"), radius_m,
        ToString(node), Name(best), Reason(best));
  }
  return absl::StrFormat(
      "There is no loop within %g m of %s: of %d proposed the one that came furthest, between %s, "
      "is %s: %s.",
      radius_m, ToString(node), here.size(), Name(best), ToString(best.verdict), Reason(best));
}

void Shorten(google::protobuf::RepeatedPtrField<std::string>* ids) {
  if (ids->size() > kMaxListedIds) ids->DeleteSubrange(kMaxListedIds, ids->size() - kMaxListedIds);
}

}  // namespace

absl::StatusOr<v1::ListLoopClosuresResponse> ListLoopClosures(
    const MapRegistry& registry, const v1::ListLoopClosuresRequest& request) {
  ASSIGN_OR_RETURN(const std::shared_ptr<HostedMap> map, registry.Find(request.map()));
  ASSIGN_OR_RETURN(const Filter filter, ReadFilter(request));
  const std::shared_ptr<const MapSnapshot> snapshot = map->published().snapshot;
  std::vector<const ClosureRecord*> closures;
  std::vector<std::string> keys;
  for (size_t i = 0; i < snapshot->closures.size(); ++i) {
    if (!filter.Matches(snapshot->closures[i])) continue;
    closures.push_back(&snapshot->closures[i]);
    keys.push_back(absl::StrFormat("%012d", i));  // in the order received
  }
  ASSIGN_OR_RETURN(Page page, SelectPage(keys, request.page_size(), request.page_token()));
  v1::ListLoopClosuresResponse response;
  for (size_t i = page.begin; i < page.end; ++i) {
    *response.add_loop_closures() = ToProto(*closures[i]);
  }
  response.set_next_page_token(page.next_page_token);
  return response;
}

absl::StatusOr<v1::ExplainLoopClosuresResponse> ExplainLoopClosures(
    const MapRegistry& registry, const v1::ExplainLoopClosuresRequest& request) {
  ASSIGN_OR_RETURN(const std::shared_ptr<HostedMap> map, registry.Find(request.map()));
  ASSIGN_OR_RETURN(const NodeId node, AtField("node", FromProto(request.node())));
  const double radius_m = request.radius_m() == 0 ? kDefaultRadiusM : request.radius_m();
  if (!(radius_m > 0 && std::isfinite(radius_m))) {
    return InvalidField("radius_m", "must be positive and finite, or 0 for 5 m");
  }
  const std::shared_ptr<const MapSnapshot> snapshot = map->published().snapshot;
  ASSIGN_OR_RETURN(const SnapshotMission* mission, FindMission(*snapshot, node));
  const std::vector<double> travelled_m = TravelledM(*mission);
  const auto is_here = [&](const NodeId& end) {
    return end.mission == node.mission && end.index < static_cast<int64_t>(travelled_m.size()) &&
           std::abs(travelled_m[end.index] - travelled_m[node.index]) <= radius_m;
  };
  std::vector<const ClosureRecord*> here;
  for (const ClosureRecord& record : snapshot->closures) {
    if (is_here(record.candidate.from) || is_here(record.candidate.to)) here.push_back(&record);
  }
  std::stable_sort(here.begin(), here.end(), [](const ClosureRecord* a, const ClosureRecord* b) {
    const int rank_a = Rank(a->verdict), rank_b = Rank(b->verdict);
    return rank_a != rank_b ? rank_a < rank_b : a->candidate.score > b->candidate.score;
  });
  const std::optional<LoopCandidate> nearest = map->detector().MostSimilar(node);
  v1::ExplainLoopClosuresResponse response;
  response.set_explanation(Explain(node, radius_m, here, nearest));
  for (size_t i = 0; i < std::min(here.size(), kMaxExplained); ++i) {
    *response.add_candidates() = ToProto(*here[i]);
  }
  if (nearest.has_value()) {
    *response.mutable_nearest() = ToProto(nearest->from);
    response.set_nearest_score(nearest->score);
    response.set_score_threshold(nearest->score_threshold);
  }
  return response;
}

namespace {

void AddStages(const CycleTimes& times, v1::Revision& revision) {
  const std::array<double, 5> seconds = Seconds(times);
  for (size_t i = 0; i < seconds.size(); ++i) {
    v1::StageTime& stage = *revision.add_stages();
    stage.set_stage(kStageNames[i]);
    stage.set_seconds(seconds[i]);
  }
}

}  // namespace

absl::StatusOr<v1::ListRevisionsResponse> ListRevisions(const MapRegistry& registry,
                                                        const v1::ListRevisionsRequest& request) {
  ASSIGN_OR_RETURN(const std::shared_ptr<HostedMap> map, registry.Find(request.map()));
  const std::vector<HostedMap::KeptRevision> revisions = map->revisions();
  std::vector<std::string> keys;
  for (const HostedMap::KeptRevision& revision : revisions) {
    // Newest first, and the keys increase.
    keys.push_back(absl::StrFormat("%020u", ~revision.record.revision));
  }
  ASSIGN_OR_RETURN(Page page, SelectPage(keys, request.page_size(), request.page_token()));
  v1::ListRevisionsResponse response;
  for (size_t i = page.begin; i < page.end; ++i) {
    v1::Revision& revision = *response.add_revisions() = ToProto(revisions[i].record);
    if (revisions[i].times.has_value()) AddStages(*revisions[i].times, revision);
    Shorten(revision.mutable_accepted());
    Shorten(revision.mutable_dropped());
  }
  response.set_next_page_token(page.next_page_token);
  return response;
}

}  // namespace overtone
