// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/internal/submap_outbox.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {
namespace {

int64_t Size(const SharedBytes& bytes) { return static_cast<int64_t>(bytes->size()); }

}  // namespace

absl::Status InMemoryOutbox::Reserve(int64_t bytes) {
  if (bytes_ + bytes > capacity_bytes_) {
    return absl::ResourceExhaustedError(absl::StrCat(
        "outbox full: ", bytes_, " of ", capacity_bytes_, " bytes wait for the server"));
  }
  MakeRoom(bytes);
  bytes_ += bytes;
  return absl::OkStatus();
}

void InMemoryOutbox::MakeRoom(int64_t bytes) {
  for (; !blobs_.empty() && bytes_ + blobs_.bytes() + bytes > capacity_bytes_; ++clouds_dropped_) {
    blobs_.PopFront();
  }
}

void InMemoryOutbox::PushBlob(WaitingBlob blob) {
  const int64_t bytes = Size(blob.bytes);
  if (bytes_ + bytes > capacity_bytes_) {
    ++clouds_dropped_;
    return;
  }
  MakeRoom(bytes);
  blobs_.Push(std::move(blob));
}

absl::Status InMemoryOutbox::PushSubmap(WaitingSubmap submap, std::vector<WaitingBlob> blobs) {
  absl::MutexLock lock(&mutex_);
  RETURN_IF_ERROR(Reserve(Size(submap.bytes)));
  last_sequence_ = std::max(last_sequence_, submap.sequence);
  submaps_.push_back(std::move(submap));
  for (WaitingBlob& blob : blobs) PushBlob(std::move(blob));
  return absl::OkStatus();
}

int64_t InMemoryOutbox::LastSequence() const {
  absl::MutexLock lock(&mutex_);
  return last_sequence_;
}

std::optional<WaitingSubmap> InMemoryOutbox::FirstSubmapFrom(int64_t sequence) const {
  absl::MutexLock lock(&mutex_);
  if (submaps_.empty() || submaps_.back().sequence < sequence) return std::nullopt;
  return submaps_[std::max<int64_t>(0, sequence - submaps_.front().sequence)];
}

void InMemoryOutbox::RemoveSubmapsThrough(int64_t sequence) {
  absl::MutexLock lock(&mutex_);
  for (; !submaps_.empty() && submaps_.front().sequence <= sequence; submaps_.pop_front()) {
    bytes_ -= Size(submaps_.front().bytes);
    ++submaps_acknowledged_;
  }
}

std::vector<WaitingSubmap> InMemoryOutbox::RemoveSubmapsFrom(int64_t sequence) {
  absl::MutexLock lock(&mutex_);
  std::vector<WaitingSubmap> removed;
  for (; !submaps_.empty() && submaps_.back().sequence >= sequence; submaps_.pop_back()) {
    bytes_ -= Size(submaps_.back().bytes);
    removed.push_back(std::move(submaps_.back()));
  }
  std::reverse(removed.begin(), removed.end());
  blobs_.RemoveFrom(sequence);
  return removed;
}

SharedBytes InMemoryOutbox::FindBlob(const std::string& sha256) const {
  absl::MutexLock lock(&mutex_);
  return blobs_.Find(sha256);
}

void InMemoryOutbox::RemoveBlob(const std::string& sha256) {
  absl::MutexLock lock(&mutex_);
  blobs_.Remove(sha256);
}

void InMemoryOutbox::DropBlob(const std::string& sha256) {
  absl::MutexLock lock(&mutex_);
  clouds_dropped_ += blobs_.Remove(sha256);
}

void InMemoryOutbox::RemoveBlobsThrough(int64_t sequence) {
  absl::MutexLock lock(&mutex_);
  blobs_.RemoveThrough(sequence);
}

absl::Status InMemoryOutbox::PushLoopClosures(SharedBytes batch) {
  absl::MutexLock lock(&mutex_);
  RETURN_IF_ERROR(Reserve(Size(batch)));
  loop_closures_.push_back(std::move(batch));
  return absl::OkStatus();
}

SharedBytes InMemoryOutbox::FrontLoopClosures() const {
  absl::MutexLock lock(&mutex_);
  return loop_closures_.empty() ? nullptr : loop_closures_.front();
}

void InMemoryOutbox::PopLoopClosures() {
  absl::MutexLock lock(&mutex_);
  if (loop_closures_.empty()) return;
  bytes_ -= Size(loop_closures_.front());
  loop_closures_.pop_front();
}

OutboxLevel InMemoryOutbox::Level() const {
  absl::MutexLock lock(&mutex_);
  OutboxLevel level;
  level.submaps = static_cast<int64_t>(submaps_.size());
  level.loop_closure_batches = static_cast<int64_t>(loop_closures_.size());
  level.blobs = blobs_.size();
  level.bytes = bytes_ + blobs_.bytes();
  level.submaps_acknowledged = submaps_acknowledged_;
  level.clouds_dropped = clouds_dropped_;
  return level;
}

bool InMemoryOutbox::AwaitEmpty(absl::Duration timeout) const {
  absl::MutexLock lock(&mutex_);
  return mutex_.AwaitWithTimeout(absl::Condition(this, &InMemoryOutbox::Empty), timeout);
}

}  // namespace overtone
