// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/robot_player.h"

#include <algorithm>
#include <utility>

#include "absl/memory/memory.h"
#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {
namespace {

// Well below the wire's limits of 2000 keyframes, 2000 closures and 1 MiB per submap.
constexpr int64_t kMaxKeyframesPerSubmap = 500;
constexpr size_t kMaxClosuresPerMessage = 500;
// Sightings, candidates and absolute poses count 1. A cloud counts for its share of memory.
constexpr int kMaxLoadPerSubmap = 1500;
constexpr int kCloudLoad = 15;

template <typename Observation>
void AddLoad(const std::vector<Observation>& observations, int load, std::vector<int>* loads) {
  for (const Observation& observation : observations) (*loads)[observation.index] += load;
}

// The index in this mission with which a measurement comes to light: the later one.
int64_t LaterIndex(const MissionId& mission, const NodeId& from, const NodeId& to) {
  int64_t later = -1;
  for (const NodeId& node : {from, to}) {
    if (node.mission == mission) later = std::max(later, node.index);
  }
  return later;
}

std::vector<int> LoadOf(const RobotRecording& recording) {
  std::vector<int> load(recording.keyframes.size(), 0);
  AddLoad(recording.observations.clouds, kCloudLoad, &load);
  AddLoad(recording.observations.landmark_sightings, 1, &load);
  AddLoad(recording.observations.robot_sightings, 1, &load);
  AddLoad(recording.observations.absolute_poses, 1, &load);
  for (const ScoredCandidate& candidate : recording.candidates) {
    const int64_t later = LaterIndex(recording.id, candidate.from, candidate.to);
    if (later >= 0) ++load[later];
  }
  return load;
}

Json ChangesToJson(const ConstraintBatch& batch, double time_s) {
  Json changes = Json::array();
  for (const Constraint& constraint : batch.add) {
    changes.push_back(ToJson(ConstraintRecord{ConstraintAction::kAdd, constraint, time_s}));
  }
  for (const Constraint& constraint : batch.update) {
    changes.push_back(ToJson(ConstraintRecord{ConstraintAction::kUpdate, constraint, time_s}));
  }
  for (const std::string& id : batch.retract) {
    Constraint constraint;
    constraint.id = id;
    constraint.revision = batch.revision;
    changes.push_back(ToJson(ConstraintRecord{ConstraintAction::kRetract, constraint, time_s}));
  }
  return changes;
}

// Row by row: large, mid, small.
Json DiscrepancyToJson(const Eigen::MatrixXd& discrepancy) {
  Json rows = Json::array();
  for (int row = 0; row < discrepancy.rows(); ++row) {
    rows.push_back({discrepancy(row, 0), discrepancy(row, 1), discrepancy(row, 2)});
  }
  return rows;
}

Json TrajectoryToJson(const std::vector<OnboardPose>& trajectory) {
  Json poses = Json::array();
  for (const OnboardPose& pose : trajectory) poses.push_back(ToJson(pose.estimate_from_body));
  return poses;
}

Json ToJson(const SynchronizationReport& report, double time_s) {
  return {{"revision", report.comparison.revision},
          {"compare_ms", report.compare_ms},
          {"keyframe_index", report.comparison.keyframe_index},
          {"discrepancy", DiscrepancyToJson(report.comparison.discrepancy)},
          {"changes", ChangesToJson(report.batch, time_s)}};
}

}  // namespace

RobotPlayer::RobotPlayer(RobotRecording recording, absl::Duration timeout)
    : recording_(std::move(recording)), timeout_(timeout), load_(LoadOf(recording_)) {}

absl::StatusOr<std::unique_ptr<RobotPlayer>> RobotPlayer::Create(RobotRecording recording,
                                                                 MappingClientOptions options,
                                                                 absl::Duration timeout) {
  options.mission = recording.id;
  options.min_time_between_comparisons = absl::InfiniteDuration();
  auto player = absl::WrapUnique(new RobotPlayer(std::move(recording), timeout));
  ASSIGN_OR_RETURN(player->client_, MappingClient::Create(std::move(options), &player->estimator_));
  RETURN_IF_ERROR(player->GoOn());
  return player;
}

// With an outbox on disk, after what an earlier process of this mission handed over.
absl::Status RobotPlayer::GoOn() {
  const SubmapPosition next = client_->NextSubmap();
  if (next.first_index > recording_.keyframes.size()) {
    return absl::FailedPreconditionError(absl::StrCat("the outbox goes on at keyframe ",
                                                      next.first_index,
                                                      ", which the recording does not have"));
  }
  RETURN_IF_ERROR(AddToEstimator(0, next.first_index));
  next_index_ = next.first_index;
  next_sequence_ = next.sequence;
  for (const LoopClosure& closure : recording_.closures) {
    closures_sent_ += ComesToLight(closure.from, closure.to, 0, next_index_);
  }
  return absl::OkStatus();
}

double RobotPlayer::TimeOf(int64_t index) const {
  return SecondsBetween(recording_.keyframes[0].stamp, recording_.keyframes[index].stamp);
}

absl::StatusOr<Json> RobotPlayer::Advance(double time_s) {
  const int64_t count = static_cast<int64_t>(recording_.keyframes.size());
  while (next_index_ < count && TimeOf(next_index_) <= time_s) {
    const int64_t begin = next_index_;
    const int64_t end = EndOfSubmap(begin, time_s);
    RETURN_IF_ERROR(AddToEstimator(begin, end));
    RETURN_IF_ERROR(Upload(begin, end));
    next_index_ = end;
  }
  RETURN_IF_ERROR(client_->WaitUntilAcknowledged(timeout_));
  return Json{
      {"keyframes", next_index_}, {"closures", closures_sent_}, {"done", next_index_ == count}};
}

int64_t RobotPlayer::EndOfSubmap(int64_t begin, double time_s) const {
  const int64_t limit =
      std::min<int64_t>(begin + kMaxKeyframesPerSubmap, recording_.keyframes.size());
  int64_t end = begin + 1;
  int load = load_[begin];
  while (end < limit && TimeOf(end) <= time_s && load + load_[end] <= kMaxLoadPerSubmap) {
    load += load_[end++];
  }
  return end;
}

absl::Status RobotPlayer::AddToEstimator(int64_t begin, int64_t end) {
  for (int64_t i = begin; i < end; ++i) {
    const Keyframe& keyframe = recording_.keyframes[i];
    const Rigid3d motion = i == 0 ? keyframe.mission_from_body
                                  : recording_.keyframes[i - 1].mission_from_body.Inverse() *
                                        keyframe.mission_from_body;
    RETURN_IF_ERROR(estimator_.AddKeyframe(i, keyframe.stamp, motion, keyframe.motion_covariance));
  }
  return absl::OkStatus();
}

absl::Status RobotPlayer::Upload(int64_t begin, int64_t end) {
  Submap submap;
  submap.sequence = next_sequence_++;
  submap.first_index = begin;
  submap.keyframes.assign(recording_.keyframes.begin() + begin, recording_.keyframes.begin() + end);
  std::vector<LoopClosure> closures;
  for (const LoopClosure& closure : recording_.closures) {
    if (ComesToLight(closure.from, closure.to, begin, end)) closures.push_back(closure);
  }
  for (const ScoredCandidate& candidate : recording_.candidates) {
    if (ComesToLight(candidate.from, candidate.to, begin, end)) {
      submap.candidates.push_back(candidate);
    }
  }
  RETURN_IF_ERROR(AddObservations(recording_.observations, begin, end, &submap));
  const size_t in_submap = std::min(closures.size(), kMaxClosuresPerMessage);
  submap.loop_closures.assign(closures.begin(), closures.begin() + in_submap);
  RETURN_IF_ERROR(Hand(submap));
  for (size_t i = in_submap; i < closures.size(); i += kMaxClosuresPerMessage) {
    const size_t stop = std::min(closures.size(), i + kMaxClosuresPerMessage);
    RETURN_IF_ERROR(client_->AddLoopClosures({closures.begin() + i, closures.begin() + stop}));
  }
  closures_sent_ += static_cast<int64_t>(closures.size());
  return absl::OkStatus();
}

// A full outbox empties as the server acknowledges. A recording is read faster than its clouds are
// encoded: one submap at a time.
absl::Status RobotPlayer::Hand(const Submap& submap) {
  absl::Status status = client_->AddSubmap(submap);
  if (absl::IsResourceExhausted(status)) {
    RETURN_IF_ERROR(client_->WaitUntilAcknowledged(timeout_));
    status = client_->AddSubmap(submap);
  }
  RETURN_IF_ERROR(status);
  return client_->WaitUntilPersisted(timeout_);
}

bool RobotPlayer::ComesToLight(const NodeId& from, const NodeId& to, int64_t begin,
                               int64_t end) const {
  const int64_t later = LaterIndex(recording_.id, from, to);
  return later >= begin && later < end;
}

absl::StatusOr<Json> RobotPlayer::Compare(uint64_t min_revision) {
  if (next_index_ == 0) return absl::FailedPreconditionError("compare before the first advance");
  const double time_s = TimeOf(next_index_ - 1);
  RETURN_IF_ERROR(client_->WaitForKeyframe(next_index_ - 1, min_revision, timeout_));
  Json answer = {{"time_s", time_s}};
  const absl::StatusOr<SynchronizationReport> report = client_->Synchronize();
  if (report.ok()) {
    RETURN_IF_ERROR(report->host_status);
    answer.update(ToJson(*report, time_s));
  } else if (absl::IsFailedPrecondition(report.status())) {  // too short to be compared as yet
    answer["skipped"] = std::string(report.status().message());
  } else {
    return report.status();
  }
  const MappingClientStats stats = client_->Stats();
  answer["bytes_up"] = stats.bytes_sent;
  answer["bytes_down"] = stats.bytes_received;
  answer["trajectory"] = TrajectoryToJson(estimator_.Trajectory());
  return answer;
}

}  // namespace overtone
