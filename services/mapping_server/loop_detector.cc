// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/loop_detector.h"

#include <utility>

#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/field_path.h"
#include "spdlog/spdlog.h"

namespace overtone {
namespace {

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

LoopDetector::LoopDetector(const LoopDetectorOptions& options, Sink sink)
    : options_(options),
      sink_(std::move(sink)),
      verifier_(std::make_unique<CloudVerifier>(options.verifier, options.max_views)),
      library_(options.gather_length_m, options.max_views),
      proposer_(std::make_unique<ScanContextProposer>(options.proposer)),
      pool_(options.enabled ? options.num_threads : 0) {}

void LoopDetector::AddSubmap(const MissionId& mission, const Submap& submap) {
  if (options_.enabled) library_.AddSubmap(mission, submap);
  if (submap.candidates.empty()) return;
  {
    absl::MutexLock lock(&mutex_);
    waiting_.insert(waiting_.end(), submap.candidates.begin(), submap.candidates.end());
  }
  SortWaiting();
}

void LoopDetector::AddCloud(const NodeId& node, std::shared_ptr<const std::string> blob) {
  if (!options_.enabled) return;
  library_.AddCloud(node, std::move(blob));
  pool_.Post([this, node] { Describe(node); });
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

void LoopDetector::Describe(const NodeId& node) {
  const auto view = library_.View(node);
  if (!view.ok()) {
    spdlog::warn("no loops at {}: {}", ToString(node), view.status().ToString());
    return;
  }
  std::vector<LoopCandidate> candidates;
  {
    absl::MutexLock lock(&mutex_);
    candidates = proposer_->Propose(**view);
  }
  for (LoopCandidate& candidate : candidates) {
    pool_.Post([this, candidate = std::move(candidate)] { Verify(candidate); });
  }
}

void LoopDetector::Verify(LoopCandidate candidate) {
  const auto from = library_.View(candidate.from);
  const auto to = library_.View(candidate.to);
  absl::Status status = from.ok() ? to.status() : from.status();
  if (status.ok()) status = verifier_->Verify(**from, **to, candidate);
  if (!status.ok()) {
    spdlog::warn("{} and {} cannot be compared: {}", ToString(candidate.from),
                 ToString(candidate.to), status.ToString());
    // The robot's own word stands where the clouds say nothing.
    if (candidate.proposer == LoopEvidence::kRobotScore) {
      sink_.on_scored_pair({candidate.from, candidate.to, candidate.score});
    }
    return;
  }
  sink_.on_candidate(std::move(candidate));
}

void LoopDetector::SortWaiting() {
  std::vector<ScoredCandidate> without_clouds;
  {
    absl::MutexLock lock(&mutex_);
    std::vector<ScoredCandidate> waiting;
    for (const ScoredCandidate& pair : waiting_) {
      if (library_.HasCloud(pair.from) && library_.HasCloud(pair.to)) {
        pool_.Post([this, candidate = CandidateOf(pair)] { Verify(candidate); });
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
