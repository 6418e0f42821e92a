// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/loop_detector.h"

#include <algorithm>
#include <utility>

#include "overtone/core/common/status_macros.h"
#include "overtone/core/mapping/loop_closure.h"
#include "overtone/core/place_recognition/field_of_view.h"
#include "overtone/proto/conversion/field_path.h"
#include "overtone/services/mapping_server/log_limit.h"

namespace overtone {
namespace {

// Between neighbouring keyframes odometry is never so wrong: the registration has slipped.
constexpr double kMaxRefinementM = 1;
constexpr double kMaxRefinementRad = 0.5;
// Variance of many motions in a row, over that of as many independent ones.
constexpr double kSerialCorrelation = 4;

// Nothing but the score is known: the verifier starts from one and the same pose.
LoopCandidate CandidateOf(const ScoredCandidate& pair) {
  LoopCandidate candidate;
  candidate.from = pair.from;
  candidate.to = pair.to;
  candidate.proposer = LoopEvidence::kRobotScore;
  candidate.score = pair.score;
  return candidate;
}

}  // namespace

absl::Status LoopDetectorOptions::Validate() const {
  if (num_threads < 1 || num_threads > 256) {
    return InvalidField("num_threads", "must be from 1 to 256");
  }
  if (!(gather_length_m >= 0 && gather_length_m <= 1000)) {
    return InvalidField("gather_length_m", "must be from 0 to 1000");
  }
  if (max_views < 2) return InvalidField("max_views", "must be at least 2");
  RETURN_IF_ERROR(proposer.Validate());
  return verifier.Validate();
}

struct LoopDetector::Search {
  SearchResult result;
  size_t open = 0;  // candidates
};

LoopDetector::LoopDetector(const LoopDetectorOptions& options, CloudLibrary::BlobSource source,
                           Sink sink)
    : options_(options),
      sink_(std::move(sink)),
      verifier_(std::make_unique<CloudVerifier>(options.verifier, options.max_views)),
      library_(options.gather_length_m, options.max_views, std::move(source)),
      proposer_(std::make_unique<ScanContextProposer>(options.proposer)),
      pool_(options.enabled ? options.num_threads : 0),
      describer_(options.enabled ? 1 : 0) {}

void LoopDetector::AddSubmap(const MissionId& mission, const Submap& submap) {
  library_.AddSubmap(mission, submap);
  if (submap.candidates.empty()) return;
  {
    absl::MutexLock lock(&mutex_);
    waiting_.insert(waiting_.end(), submap.candidates.begin(), submap.candidates.end());
  }
  SortWaiting();
}

void LoopDetector::AddCloud(const NodeId& node, const std::string& sha256) {
  library_.AddCloud(node, sha256);
  if (!options_.enabled) return;
  PostDescribe(node);
  SortWaiting();
}

void LoopDetector::PostDescribe(const NodeId& node) {
  absl::MutexLock lock(&mutex_);
  if (replaying_) {
    replayed_clouds_.push_back(node);
  } else {
    describer_.Post([this, node] { Describe(node); });
  }
}

void LoopDetector::BeginReplay() {
  absl::MutexLock lock(&mutex_);
  replaying_ = true;
}

void LoopDetector::NoteSearch(const NodeId& node) {
  absl::MutexLock lock(&mutex_);
  searched_.insert(node);
}

void LoopDetector::NoteMotion(const RefinedMotion& motion) {
  const NodeId& node = motion.measurement.to;
  if (motion.determined) library_.SetMotionInto(node, motion.measurement.previous_from_this);
  absl::MutexLock lock(&mutex_);
  refined_.insert(node);
}

void LoopDetector::NotePair(const NodeId& from, const NodeId& to) {
  absl::MutexLock lock(&mutex_);
  const auto pair =
      std::find_if(waiting_.begin(), waiting_.end(), [&](const ScoredCandidate& candidate) {
        return candidate.from == from && candidate.to == to;
      });
  if (pair != waiting_.end()) waiting_.erase(pair);
}

void LoopDetector::EndReplay() {
  std::vector<NodeId> clouds;
  {
    absl::MutexLock lock(&mutex_);
    replaying_ = false;
    clouds.swap(replayed_clouds_);
  }
  for (const NodeId& node : clouds) PostDescribe(node);
  SortWaiting();
}

void LoopDetector::CloudGone(const NodeId& node) {
  library_.CloudGone(node);
  SortWaiting();
}

std::optional<LoopCandidate> LoopDetector::MostSimilar(const NodeId& node) const {
  absl::MutexLock lock(&mutex_);
  return proposer_->MostSimilar(node);
}

// A planar scan against what the keyframe before it had gathered.
absl::Status LoopDetector::RefineMotion(const NodeId& node) {
  const NodeId previous = {node.mission, node.index - 1};
  if (node.index < 1 || !library_.HasCloud(previous)) return absl::OkStatus();
  ASSIGN_OR_RETURN(const PlaceView scan, library_.Scan(node));
  if (!IsPlanar(*scan.cloud, options_.verifier.planar_registration.planar_thickness_m)) {
    return absl::OkStatus();
  }
  ASSIGN_OR_RETURN(const std::shared_ptr<const PlaceView> before, library_.View(previous));
  LoopCandidate motion;
  motion.from = previous;
  motion.to = node;
  motion.from_tform_to = library_.MotionInto(node);
  RETURN_IF_ERROR(verifier_->Verify(*before, scan, motion));
  if (JudgeFigures(motion) != ClosureVerdict::kPending) return absl::OkStatus();
  const Rigid3d error = library_.MotionInto(node).Inverse() * motion.from_tform_to;
  if (error.translation.norm() > kMaxRefinementM ||
      LogSO3(error.rotation).norm() > kMaxRefinementRad) {
    return absl::OkStatus();
  }
  const bool determined = !IsWeak(motion);
  if (determined) library_.SetMotionInto(node, motion.from_tform_to);
  // One scan errs as the one before it did: they are not independent.
  sink_.on_motion(
      {{node, motion.from_tform_to, kSerialCorrelation * motion.covariance}, determined});
  return absl::OkStatus();
}

void LoopDetector::Describe(const NodeId& node) {
  bool searched = false, refined = false;
  {
    absl::MutexLock lock(&mutex_);
    searched = searched_.contains(node);
    refined = searched || refined_.contains(node);
  }
  if (options_.refine_planar_motion && !refined) {
    const absl::Status status = RefineMotion(node);
    if (!status.ok()) {
      spdlog::debug("motion into {} not refined: {}", ToString(node), status.ToString());
    }
  }
  const auto view = library_.View(node);
  if (!view.ok()) {
    LogPeer(spdlog::level::warn, "no loops", "no loops at {}: {}", ToString(node),
            view.status().ToString());
    return;
  }
  auto search = std::make_shared<Search>();
  search->result.node = node;
  std::vector<LoopCandidate> candidates;
  {
    absl::MutexLock lock(&mutex_);
    if (searched) return proposer_->Keep(**view);
    candidates = proposer_->Propose(**view);
    search->open = candidates.size();
  }
  if (candidates.empty()) return sink_.on_search(std::move(search->result));
  for (LoopCandidate& candidate : candidates) {
    pool_.Post(
        [this, search, candidate = std::move(candidate)] { VerifyOfSearch(*search, candidate); });
  }
}

absl::Status LoopDetector::Verify(LoopCandidate& candidate) {
  const auto from = library_.View(candidate.from);
  const auto to = library_.View(candidate.to);
  absl::Status status = from.ok() ? to.status() : from.status();
  if (status.ok()) status = verifier_->Verify(**from, **to, candidate);
  if (!status.ok()) {
    LogPeer(spdlog::level::warn, "not compared", "{} and {} cannot be compared: {}",
            ToString(candidate.from), ToString(candidate.to), status.ToString());
  }
  return status;
}

void LoopDetector::VerifyOfSearch(Search& search, LoopCandidate candidate) {
  const bool verified = Verify(candidate).ok();
  {
    absl::MutexLock lock(&mutex_);
    if (verified) search.result.candidates.push_back(std::move(candidate));
    if (--search.open > 0) return;
  }
  sink_.on_search(std::move(search.result));
}

void LoopDetector::VerifyPair(LoopCandidate candidate) {
  if (Verify(candidate).ok()) {
    sink_.on_measured_pair(std::move(candidate));
  } else {
    // The robot's own word stands where the clouds say nothing.
    sink_.on_scored_pair({candidate.from, candidate.to, candidate.score});
  }
}

void LoopDetector::SortWaiting() {
  std::vector<ScoredCandidate> without_clouds;
  {
    absl::MutexLock lock(&mutex_);
    if (replaying_) return;
    std::vector<ScoredCandidate> waiting;
    for (const ScoredCandidate& pair : waiting_) {
      if (!options_.enabled) {
        without_clouds.push_back(pair);
      } else if (library_.HasCloud(pair.from) && library_.HasCloud(pair.to)) {
        pool_.Post([this, candidate = CandidateOf(pair)] { VerifyPair(candidate); });
      } else if (library_.ExpectsCloud(pair.from) && library_.ExpectsCloud(pair.to)) {
        waiting.push_back(pair);
      } else {
        without_clouds.push_back(pair);
      }
    }
    waiting_ = std::move(waiting);
  }
  for (const ScoredCandidate& pair : without_clouds) sink_.on_scored_pair(pair);
}

}  // namespace overtone
