// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/rpc/upload_submaps.h"

#include <chrono>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/field_path.h"
#include "overtone/proto/conversion/id_conversion.h"
#include "overtone/proto/conversion/limits.h"
#include "overtone/proto/conversion/sha256.h"
#include "overtone/proto/conversion/status_conversion.h"
#include "overtone/proto/conversion/submap_conversion.h"
#include "overtone/services/mapping_server/log_limit.h"
#include "overtone/services/mapping_server/rpc/upload_frames.h"
#include "overtone/services/mapping_server/submap_digest.h"

namespace overtone {
namespace {

// Answers that the peer has not taken yet; more would only grow memory.
constexpr size_t kMaxAnswers = 64;

}  // namespace

UploadReactor* UploadSubmaps::Start(StreamAccess access, StreamQuota quota, MapRegistry* registry,
                                    UploadSessions* sessions, const ServerLimits& limits,
                                    std::string request_id) {
  auto reactor = std::make_shared<UploadSubmaps>(std::move(access), std::move(quota), registry,
                                                 sessions, limits, std::move(request_id));
  reactor->self_ = reactor;
  const absl::Status admitted = reactor->quota_.Open();
  absl::MutexLock lock(&reactor->mutex_);
  if (!admitted.ok()) reactor->ending_ = admitted;
  reactor->age_.Start(absl::Seconds(limits.max_connection_age_s), std::weak_ptr(reactor));
  reactor->Advance();
  return reactor.get();
}

UploadSubmaps::UploadSubmaps(StreamAccess access, StreamQuota quota, MapRegistry* registry,
                             UploadSessions* sessions, const ServerLimits& limits,
                             std::string request_id)
    : access_(std::move(access)),
      registry_(registry),
      sessions_(sessions),
      window_bytes_(limits.upload_window_bytes),
      assembly_(limits.max_blob_bytes),
      quota_(std::move(quota)),
      traffic_(std::make_shared<RobotCounters>()) {
  log_.request_id = std::move(request_id);
}

void UploadSubmaps::End(const absl::Status& status) {
  absl::MutexLock lock(&mutex_);
  if (!ending_.has_value()) ending_ = status;
  map_.reset();
  Advance();
}

void UploadSubmaps::Drain(const absl::Status& status) {
  absl::MutexLock lock(&mutex_);
  if (!draining_.has_value()) draining_ = status;
  Advance();
}

void UploadSubmaps::OnReadDone(bool ok) {
  const LogScope scope(&log_);
  absl::Status status;
  absl::Duration pause;
  if (ok && BeginFrame()) {
    const auto bytes = static_cast<int64_t>(request_.ByteSizeLong());
    CountReceived(bytes);
    pause = quota_.Charge(bytes);
    status = OnFrame();
  } else if (!ok && map_id_.empty()) {
    status = InvalidField("header", "the stream ended before it");
  }
  // Decoded, a message of many empty fields takes a hundred times its size.
  request_ = v1::UploadSubmapsRequest();
  absl::MutexLock lock(&mutex_);
  handling_ = false;
  reading_ = false;
  half_closed_ = half_closed_ || !ok;
  if (!status.ok() && !ending_.has_value()) ending_ = status;
  if (pause > absl::ZeroDuration()) PauseReading(pause);
  Advance();
}

bool UploadSubmaps::BeginFrame() {
  absl::MutexLock lock(&mutex_);
  handling_ = !finished_;
  return handling_;
}

void UploadSubmaps::PauseReading(absl::Duration pause) {
  LogPeer(spdlog::level::info, "upload slowed", "map {}: {} is over its quota; read on in {} ms",
          map_id_, ToString(mission_), absl::ToInt64Milliseconds(pause));
  paused_ = true;
  quota_alarm_.Set(std::chrono::system_clock::now() + absl::ToChronoMicroseconds(pause),
                   // The alarm is ours and keeps its function: a shared pointer would never go.
                   [weak = weak_from_this()](bool) {
                     const std::shared_ptr<UploadSubmaps> self = weak.lock();
                     if (self == nullptr) return;
                     absl::MutexLock lock(&self->mutex_);
                     self->paused_ = false;
                     self->Advance();
                   });
}

absl::Status UploadSubmaps::OnFrame() {
  const auto frame = request_.frame_case();
  if (frame == v1::UploadSubmapsRequest::kHeader) return OnHeader(request_.header());
  if (frame == v1::UploadSubmapsRequest::FRAME_NOT_SET) return InvalidField("frame", "missing");
  if (map_id_.empty()) return InvalidField("header", "must be the first message");
  if (frame == v1::UploadSubmapsRequest::kSubmap) {
    OnSubmap(request_.submap());
  } else {
    OnBlob(request_.blob());
  }
  return absl::OkStatus();
}

absl::Status UploadSubmaps::OnHeader(const v1::UploadHeader& header) {
  if (!map_id_.empty()) return InvalidField("header", "only the first message may be one");
  RETURN_IF_ERROR(
      access_.MayWrite(header.map(), header.mission().robot(), "header.", weak_from_this()));
  RETURN_IF_ERROR(ValidateId(header.map(), "header.map"));
  ASSIGN_OR_RETURN(MissionId mission, AtField("header.mission", FromProto(header.mission())));
  RETURN_IF_ERROR(quota_.SetRobot(mission.robot));
  map_id_ = header.map();
  mission_ = std::move(mission);
  log_.map = map_id_;
  log_.robot = mission_.robot;
  log_.mission = mission_.mission;
  // Before the map is held: a change of the whole map ends those it knows, and waits for all.
  RETURN_IF_ERROR(sessions_->Open(map_id_, mission_, shared_from_this()));
  const absl::StatusOr<std::shared_ptr<HostedMap>> map = registry_->Find(map_id_);
  // A map that is only out of reach has sequences already.
  if (!map.ok() && !absl::IsNotFound(map.status())) return map.status();
  if (map.ok()) RETURN_IF_ERROR(SetMap(*map));
  const int64_t next_sequence = map.ok() ? (*map)->store().State(mission_).next_sequence : 0;
  LogPeer(spdlog::level::info, "upload opened", "map {}: {} uploads from submap {}", map_id_,
          ToString(mission_), next_sequence);
  absl::MutexLock lock(&mutex_);
  Answer(ReadyFrame(next_sequence, window_bytes_));
  if (next_sequence > 0) AskForBlobs(**map);
  return absl::OkStatus();
}

void UploadSubmaps::OnSubmap(const v1::Submap& message) {
  const int64_t bytes = static_cast<int64_t>(message.ByteSizeLong());
  const absl::Status status = Append(message, bytes);
  if (!status.ok()) Reject(message.sequence(), status, NextSequence());
}

absl::StatusOr<SubmapRecord> UploadSubmaps::Check(const v1::Submap& message) const {
  if (message.ByteSizeLong() > static_cast<size_t>(limits::kMaxSubmapBytes)) {
    return InvalidField("submap",
                        absl::StrCat(message.ByteSizeLong(), " bytes, at most 1 MiB are taken"));
  }
  ASSIGN_OR_RETURN(Submap submap, AtField("submap", FromProto(message, mission_)));
  std::string bytes = DeterministicBytes(message);
  std::string digest = Sha256(bytes);
  return SubmapRecord{mission_, std::make_shared<const Submap>(std::move(submap)), std::move(bytes),
                      std::move(digest)};
}

absl::Status UploadSubmaps::Append(const v1::Submap& message, int64_t bytes) {
  ASSIGN_OR_RETURN(SubmapRecord record, Check(message));
  std::shared_ptr<HostedMap> map = this->map();
  if (map == nullptr) {
    ASSIGN_OR_RETURN(map, registry_->Acquire(map_id_));
    RETURN_IF_ERROR(SetMap(map));
  }
  {
    absl::MutexLock lock(&mutex_);
    waiting_bytes_ += bytes;
    ++waiting_;
  }
  map->store().Append(
      std::move(record),
      [self = shared_from_this(), map, sequence = message.sequence(),
       has_clouds = message.clouds_size() > 0, bytes](const absl::StatusOr<AppendResult>& result) {
        if (result.ok() && result->added) self->registry_->Keep(map);
        self->OnAppended(*map, sequence, has_clouds, bytes, result);
      });
  return absl::OkStatus();
}

void UploadSubmaps::OnAppended(const HostedMap& map, int64_t sequence, bool has_clouds,
                               int64_t bytes, const absl::StatusOr<AppendResult>& result) {
  const LogScope scope(&log_);
  if (!result.ok()) {
    Reject(sequence, AtField("submap", result.status()), map.store().State(mission_).next_sequence);
  }
  absl::MutexLock lock(&mutex_);
  waiting_bytes_ -= bytes;
  --waiting_;
  if (result.ok()) {
    Answer(AckFrame(result->state.next_sequence - 1));
    // Looked up after the Ack is in its place: an empty Want speaks for all that is acknowledged.
    if (has_clouds) AskForBlobs(map);
  }
  Advance();
}

void UploadSubmaps::OnBlob(const v1::BlobChunk& chunk) {
  absl::optional<int64_t> wanted_bytes;
  const std::shared_ptr<HostedMap> map = this->map();
  {
    absl::MutexLock lock(&mutex_);
    const auto it = asked_.find(chunk.sha256());
    if (it != asked_.end()) wanted_bytes = it->second;
  }
  absl::optional<BlobAssembly::Outcome> outcome = assembly_.Take(chunk, wanted_bytes);
  if (!outcome.has_value()) return;
  if (wanted_bytes.has_value() && map == nullptr) return;  // the stream ends
  if (outcome->status.ok()) return PutBlob(map, outcome->sha256, std::move(outcome->blob));
  if (wanted_bytes.has_value()) map->store().AbandonBlob(mission_, outcome->sha256);
  absl::MutexLock lock(&mutex_);
  AnswerBlob(outcome->sha256, outcome->status);
  if (wanted_bytes.has_value()) AskForBlobs(*map);
}

void UploadSubmaps::PutBlob(const std::shared_ptr<HostedMap>& map, const std::string& sha256,
                            SharedBlob blob) {
  const int64_t bytes = static_cast<int64_t>(blob->size());
  {
    absl::MutexLock lock(&mutex_);
    waiting_bytes_ += bytes;
    ++waiting_;
  }
  map->store().PutBlob(sha256, std::move(blob),
                       [self = shared_from_this(), map, sha256, bytes](const absl::Status& status) {
                         absl::MutexLock lock(&self->mutex_);
                         self->waiting_bytes_ -= bytes;
                         --self->waiting_;
                         const LogScope scope(&self->log_);
                         self->AnswerBlob(sha256, status);
                         self->AskForBlobs(*map);
                         self->Advance();
                       });
}

void UploadSubmaps::AnswerBlob(const std::string& sha256, const absl::Status& status) {
  if (!status.ok()) {
    LogPeer(spdlog::level::warn, "cloud not stored", "map {}: {}: cloud not stored: {}", map_id_,
            ToString(mission_), HeaderSafe(status.ToString()));
  }
  asked_.erase(sha256);
  no_room_ = no_room_ || absl::IsResourceExhausted(status);
  Answer(BlobResultFrame(sha256, status));
}

void UploadSubmaps::AskForBlobs(const HostedMap& map) {
  if (no_room_ || asked_.size() > limits::kMaxWantsPerFrame / 2) return;
  // Those asked for are among the first of those missing, but for some that are stored and not
  // answered yet.
  const std::vector<MissingBlob> missing =
      map.store().MissingBlobs(mission_, limits::kMaxWantsPerFrame);
  std::vector<MissingBlob> wanted;
  for (const MissingBlob& blob : missing) {
    // The store may have many more than it has answered for yet.
    if (asked_.size() >= limits::kMaxWantsPerFrame) break;
    if (asked_.emplace(blob.sha256, blob.encoded_bytes).second) wanted.push_back(blob);
  }
  if (missing.empty() || !wanted.empty()) Answer(WantFrame(wanted));
}

void UploadSubmaps::Reject(int64_t sequence, const absl::Status& status,
                           int64_t expected_sequence) {
  LogPeer(spdlog::level::warn, "submap rejected", "map {}: {}: submap {} rejected: {}", map_id_,
          ToString(mission_), sequence, HeaderSafe(status.ToString()));
  absl::MutexLock lock(&mutex_);
  Answer(RejectFrame(sequence, status, expected_sequence));
}

int64_t UploadSubmaps::NextSequence() {
  const std::shared_ptr<HostedMap> map = this->map();
  return map == nullptr ? 0 : map->store().State(mission_).next_sequence;
}

std::shared_ptr<HostedMap> UploadSubmaps::map() {
  absl::MutexLock lock(&mutex_);
  return map_;
}

void UploadSubmaps::CountReceived(int64_t bytes) {
  absl::MutexLock lock(&mutex_);
  traffic_->bytes_received += bytes;
}

absl::Status UploadSubmaps::SetMap(const std::shared_ptr<HostedMap>& map) {
  absl::MutexLock lock(&mutex_);
  if (ending_.has_value()) return absl::UnavailableError("the stream is ending");
  map_ = map;
  const std::shared_ptr<const RobotCounters> before = traffic_;
  traffic_ = map->traffic().Of(mission_.robot);
  traffic_->bytes_received += before->bytes_received;
  traffic_->bytes_sent += before->bytes_sent;
  return absl::OkStatus();
}

void UploadSubmaps::Answer(v1::UploadSubmapsResponse response) {
  // An ack speaks for all before it: one that is not on its way yet is replaced.
  const bool replaces =
      response.has_ack() && answers_.size() > (writing_ ? 1 : 0) && answers_.back().has_ack();
  if (replaces) answers_.pop_back();
  answers_.push_back(std::move(response));
}

void UploadSubmaps::Advance() {
  if (finished_) return;
  if (ending_.has_value()) {
    if (!writing_) FinishWith(*ending_);
    return;
  }
  if (!writing_ && !answers_.empty()) {
    writing_ = true;
    traffic_->bytes_sent += static_cast<int64_t>(answers_.front().ByteSizeLong());
    StartWrite(&answers_.front());
  }
  const bool room = waiting_bytes_ < window_bytes_ && answers_.size() < kMaxAnswers;
  const bool no_more = half_closed_ || draining_.has_value();
  if (!reading_ && !paused_ && !no_more && room) {
    reading_ = true;
    StartRead(&request_);
  }
  if (no_more && waiting_ == 0 && !handling_ && !writing_) {
    FinishWith(half_closed_ ? absl::OkStatus() : *draining_);
  }
}

void UploadSubmaps::FinishWith(const absl::Status& status) {
  finished_ = true;
  Finish(ToGrpcStatus(status));
}

void UploadSubmaps::OnWriteDone(bool ok) {
  absl::MutexLock lock(&mutex_);
  writing_ = false;
  answers_.pop_front();
  if (!ok && !ending_.has_value()) ending_ = absl::CancelledError("the peer is gone");
  Advance();
}

void UploadSubmaps::OnCancel() {
  absl::MutexLock lock(&mutex_);
  if (!finished_) FinishWith(absl::CancelledError("the peer is gone"));
}

void UploadSubmaps::OnDone() {
  sessions_->Close(map_id_, mission_, this);
  {
    absl::MutexLock lock(&mutex_);
    map_.reset();
  }
  quota_.Close();
  quota_alarm_.Cancel();
  age_.Stop();
  self_.reset();
}

}  // namespace overtone
