// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/place_recognition/scan_context_proposer.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace overtone {
namespace {

// Neighbours of one good match are all similar: so many are looked through for distinct places.
constexpr int kMatchesPerCandidate = 10;

}  // namespace

absl::Status ScanContextProposerOptions::Validate() const {
  if (!(min_similarity >= 0 && min_similarity <= 1)) {
    return absl::InvalidArgumentError("min_similarity must be in [0, 1]");
  }
  if (max_candidates < 1) return absl::InvalidArgumentError("max_candidates must be at least 1");
  if (max_comparisons < 1) return absl::InvalidArgumentError("max_comparisons must be at least 1");
  if (!(min_separation_m >= 0)) {
    return absl::InvalidArgumentError("min_separation_m must not be negative");
  }
  if (!(min_loop_length_m >= 0)) {
    return absl::InvalidArgumentError("min_loop_length_m must not be negative");
  }
  return context.Validate();
}

bool ScanContextProposer::MayMatch(const Place& query, const Place& place) const {
  return place.node.mission != query.node.mission ||
         std::abs(query.travelled_m - place.travelled_m) >= options_.min_loop_length_m;
}

LoopCandidate ScanContextProposer::Candidate(const Place& query, const PlaceMatch& match) const {
  const Place& place = places_[match.place];
  LoopCandidate candidate;
  candidate.from = place.node;
  candidate.to = query.node;
  candidate.proposer = LoopEvidence::kScanContext;
  candidate.score = match.similarity;
  candidate.score_threshold = options_.min_similarity;
  // The match turns the place into the query.
  candidate.from_tform_to.rotation =
      BodyRotation(query.level_from_body, match.yaw_rad, place.level_from_body).conjugate();
  return candidate;
}

ScanContextProposer::Place ScanContextProposer::PlaceOf(const PlaceView& view) const {
  return {view.node, view.travelled_m, LevelFromBody(view.mission_from_body)};
}

void ScanContextProposer::Add(const Place& place, ScanContext context) {
  place_of_[place.node] = index_.Add(std::move(context));
  places_.push_back(place);
}

void ScanContextProposer::Keep(const PlaceView& view) {
  const Place place = PlaceOf(view);
  Add(place, ComputeScanContext(*view.cloud, place.level_from_body, options_.context));
}

std::vector<LoopCandidate> ScanContextProposer::Propose(const PlaceView& view) {
  const Place query = PlaceOf(view);
  ScanContext context = ComputeScanContext(*view.cloud, query.level_from_body, options_.context);
  const std::vector<PlaceMatch> matches =
      index_.Search(context, kMatchesPerCandidate * options_.max_candidates,
                    [&](int place) { return MayMatch(query, places_[place]); });
  std::vector<LoopCandidate> candidates;
  std::vector<int> chosen;
  for (const PlaceMatch& match : matches) {
    if (match.similarity < options_.min_similarity) break;
    if (static_cast<int>(candidates.size()) == options_.max_candidates) break;
    const Place& place = places_[match.place];
    const bool distinct = std::all_of(chosen.begin(), chosen.end(), [&](int other) {
      return places_[other].node.mission != place.node.mission ||
             std::abs(places_[other].travelled_m - place.travelled_m) >= options_.min_separation_m;
    });
    if (!distinct) continue;
    chosen.push_back(match.place);
    candidates.push_back(Candidate(query, match));
  }
  Add(query, std::move(context));
  return candidates;
}

std::optional<LoopCandidate> ScanContextProposer::MostSimilar(const NodeId& node) const {
  const auto found = place_of_.find(node);
  if (found == place_of_.end()) return std::nullopt;
  const Place& query = places_[found->second];
  const std::vector<PlaceMatch> matches = index_.Search(
      index_.place(found->second), 1,
      [&](int place) { return place != found->second && MayMatch(query, places_[place]); });
  if (matches.empty()) return std::nullopt;
  return Candidate(query, matches.front());
}

}  // namespace overtone
