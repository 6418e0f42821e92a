// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/internal/submap_outbox.h"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {
namespace {

using Kind = OutboxItem::Kind;

SubmapHead HeadOf(const OutboxItem& item) { return {item.sequence, item.first_index, item.size}; }

}  // namespace

SubmapOutbox::SubmapOutbox(int64_t capacity_bytes) : capacity_bytes_(capacity_bytes) {}

SubmapOutbox::SubmapOutbox(int64_t capacity_bytes, std::string path, OpenedOutbox opened,
                           Logger logger)
    : capacity_bytes_(capacity_bytes),
      path_(std::move(path)),
      logger_(std::move(logger)),
      file_(std::move(opened.file)) {
  absl::MutexLock lock(&mutex_);
  Adopt(std::move(opened.content));
}

absl::StatusOr<std::unique_ptr<SubmapOutbox>> SubmapOutbox::Open(int64_t capacity_bytes,
                                                                 const std::string& path,
                                                                 Logger logger) {
  std::error_code error;
  const bool is_new = !std::filesystem::exists(path, error);
  absl::StatusOr<OpenedOutbox> opened = OpenOutbox(path);
  // A full disk: the file comes into being once there is room.
  if (is_new && absl::IsResourceExhausted(opened.status())) opened = OpenedOutbox();
  RETURN_IF_ERROR(opened.status());
  if (!opened->set_aside.empty()) {
    logger.Error("the outbox was damaged; it is now ", opened->set_aside, ", and ",
                 opened->content.items.size(), " items of it go on");
  }
  return std::unique_ptr<SubmapOutbox>(
      new SubmapOutbox(capacity_bytes, path, *std::move(opened), std::move(logger)));
}

void SubmapOutbox::Adopt(OutboxContent content) {
  position_ = file_position_ = content.position;
  for (OutboxItem& item : content.items) {
    next_id_ = item.id + 1;
    if (item.kind == Kind::kBlob) {
      blobs_.Push(std::move(item));
      continue;
    }
    bytes_ += item.size;
    QueueOf(item.kind).push_back(std::move(item));
  }
  first_unsaved_id_ = next_id_;
  if (file_ != nullptr) synced_through_ = SavedThrough();
}

std::deque<OutboxItem>& SubmapOutbox::QueueOf(Kind kind) {
  return kind == Kind::kSubmap ? submaps_ : loop_closures_;
}

absl::Status SubmapOutbox::Reserve(int64_t bytes) {
  absl::MutexLock lock(&mutex_);
  RETURN_IF_ERROR(ReserveLocked(bytes));
  ++reservations_;
  return absl::OkStatus();
}

void SubmapOutbox::Release(int64_t bytes) {
  absl::MutexLock lock(&mutex_);
  bytes_ -= bytes;
  --reservations_;
}

absl::Status SubmapOutbox::ReserveLocked(int64_t bytes) {
  if (bytes_ + bytes > capacity_bytes_) {
    return absl::ResourceExhaustedError(absl::StrCat(
        "outbox full: ", bytes_, " of ", capacity_bytes_, " bytes wait for the server"));
  }
  MakeRoom(bytes);
  bytes_ += bytes;
  return absl::OkStatus();
}

void SubmapOutbox::MakeRoom(int64_t bytes) {
  while (!blobs_.empty() && bytes_ + blobs_.bytes() + bytes > capacity_bytes_) {
    ForgetSaved(blobs_.PopFront());
    ++position_.clouds_dropped;
  }
}

OutboxItem SubmapOutbox::NewItem(Kind kind, SharedBytes bytes) {
  OutboxItem item;
  item.id = next_id_++;
  item.kind = kind;
  item.size = static_cast<int64_t>(bytes->size());
  item.bytes = std::move(bytes);
  return item;
}

void SubmapOutbox::ForgetSaved(const OutboxItem& item) {
  if (item.saved) removed_.push_back(item.id);
}

void SubmapOutbox::ForgetSaved(const std::vector<OutboxItem>& items) {
  for (const OutboxItem& item : items) ForgetSaved(item);
}

absl::Status SubmapOutbox::PushSubmap(WaitingSubmap submap, std::vector<WaitingBlob> blobs,
                                      int64_t reserved) {
  absl::MutexLock lock(&mutex_);
  if (reserved > 0) {
    bytes_ -= reserved;
    --reservations_;
  }
  OutboxItem item = NewItem(Kind::kSubmap, std::move(submap.bytes));
  RETURN_IF_ERROR(ReserveLocked(item.size));
  item.sequence = submap.sequence;
  item.first_index = submap.first_index;
  item.num_keyframes = submap.num_keyframes;
  item.last_stamp_ns = submap.last_stamp_ns;
  position_.next_sequence = submap.sequence + 1;
  position_.next_index = submap.first_index + submap.num_keyframes;
  position_.last_stamp_ns = submap.last_stamp_ns;
  submaps_.push_back(std::move(item));
  for (WaitingBlob& blob : blobs) PushBlob(std::move(blob));
  return absl::OkStatus();
}

void SubmapOutbox::PushBlob(WaitingBlob blob) {
  const int64_t bytes = static_cast<int64_t>(blob.bytes->size());
  if (bytes_ + bytes > capacity_bytes_) {
    ++position_.clouds_dropped;
    return;
  }
  MakeRoom(bytes);
  OutboxItem item = NewItem(Kind::kBlob, std::move(blob.bytes));
  item.sequence = blob.sequence;
  item.sha256 = std::move(blob.sha256);
  blobs_.Push(std::move(item));
}

void SubmapOutbox::CountDroppedClouds(int64_t count) {
  absl::MutexLock lock(&mutex_);
  position_.clouds_dropped += count;
}

OutboxPosition SubmapOutbox::Position() const {
  absl::MutexLock lock(&mutex_);
  return position_;
}

// Without a file, or while the disk fails, there is nothing to wait for.
bool SubmapOutbox::MaySend(const OutboxItem& submap) const {
  return submap.saved || path_.empty() || !disk_ok_;
}

std::deque<OutboxItem>::iterator SubmapOutbox::FindSubmap(int64_t sequence) {
  return std::partition_point(submaps_.begin(), submaps_.end(),
                              [&](const OutboxItem& submap) { return submap.sequence < sequence; });
}

std::optional<SubmapHead> SubmapOutbox::FirstSubmapFrom(int64_t sequence) const {
  absl::MutexLock lock(&mutex_);
  const auto it =
      std::partition_point(submaps_.begin(), submaps_.end(),
                           [&](const OutboxItem& submap) { return submap.sequence < sequence; });
  if (it == submaps_.end() || !MaySend(*it)) return std::nullopt;
  return HeadOf(*it);
}

absl::StatusOr<SharedBytes> SubmapOutbox::ReadSubmap(int64_t sequence) {
  int64_t id = 0;
  {
    absl::MutexLock lock(&mutex_);
    const auto it = FindSubmap(sequence);
    if (it == submaps_.end() || it->sequence != sequence) {
      return absl::NotFoundError(absl::StrCat("submap ", sequence, " does not wait any more"));
    }
    if (it->bytes != nullptr) return it->bytes;
    id = it->id;
  }
  absl::StatusOr<SharedBytes> bytes = ReadFromFile(id);
  if (!absl::IsDataLoss(bytes.status())) return bytes;
  logger_.Error("submap ", sequence, " is damaged and lost: ", bytes.status().ToString());
  absl::MutexLock lock(&mutex_);
  const auto it = FindSubmap(sequence);
  if (it != submaps_.end() && it->id == id) {
    bytes_ -= it->size;
    ForgetSaved(*it);
    submaps_.erase(it);
  }
  return bytes;
}

absl::StatusOr<SharedBytes> SubmapOutbox::ReadFromFile(int64_t id) {
  absl::MutexLock lock(&file_mutex_);
  if (file_ == nullptr) return absl::UnavailableError("the outbox's file is not open");
  return file_->Read(id);
}

void SubmapOutbox::RemoveSubmapsThrough(int64_t sequence) {
  absl::MutexLock lock(&mutex_);
  for (; !submaps_.empty() && submaps_.front().sequence <= sequence; submaps_.pop_front()) {
    bytes_ -= submaps_.front().size;
    ForgetSaved(submaps_.front());
    ++submaps_acknowledged_;
  }
}

std::vector<SubmapHead> SubmapOutbox::RemoveSubmapsFrom(int64_t sequence) {
  absl::MutexLock lock(&mutex_);
  std::vector<SubmapHead> removed;
  for (; !submaps_.empty() && submaps_.back().sequence >= sequence; submaps_.pop_back()) {
    bytes_ -= submaps_.back().size;
    ForgetSaved(submaps_.back());
    removed.push_back(HeadOf(submaps_.back()));
  }
  std::reverse(removed.begin(), removed.end());
  ForgetSaved(blobs_.RemoveFrom(sequence));
  if (!removed.empty()) {
    position_ = {removed.front().sequence, removed.front().first_index,
                 OutboxPosition().last_stamp_ns, position_.clouds_dropped};
  }
  return removed;
}

std::optional<int64_t> SubmapOutbox::BlobSize(const std::string& sha256) const {
  absl::MutexLock lock(&mutex_);
  const OutboxItem* blob = blobs_.Find(sha256);
  return blob == nullptr ? std::nullopt : std::optional<int64_t>(blob->size);
}

SharedBytes SubmapOutbox::FindBlob(const std::string& sha256) {
  int64_t id = 0;
  {
    absl::MutexLock lock(&mutex_);
    const OutboxItem* blob = blobs_.Find(sha256);
    if (blob == nullptr || blob->bytes != nullptr) return blob == nullptr ? nullptr : blob->bytes;
    id = blob->id;
  }
  const absl::StatusOr<SharedBytes> bytes = ReadFromFile(id);
  if (bytes.ok()) return *bytes;
  logger_.Warning("a cloud in the outbox cannot be read: ", bytes.status().ToString());
  DropBlob(sha256);
  return nullptr;
}

void SubmapOutbox::RemoveBlob(const std::string& sha256) {
  absl::MutexLock lock(&mutex_);
  ForgetSaved(blobs_.Remove(sha256));
}

void SubmapOutbox::DropBlob(const std::string& sha256) {
  absl::MutexLock lock(&mutex_);
  const std::vector<OutboxItem> dropped = blobs_.Remove(sha256);
  ForgetSaved(dropped);
  position_.clouds_dropped += static_cast<int64_t>(dropped.size());
}

void SubmapOutbox::RemoveBlobsThrough(int64_t sequence) {
  absl::MutexLock lock(&mutex_);
  ForgetSaved(blobs_.RemoveThrough(sequence));
}

absl::Status SubmapOutbox::PushLoopClosures(SharedBytes batch) {
  absl::MutexLock lock(&mutex_);
  RETURN_IF_ERROR(ReserveLocked(static_cast<int64_t>(batch->size())));
  loop_closures_.push_back(NewItem(Kind::kLoopClosures, std::move(batch)));
  return absl::OkStatus();
}

SharedBytes SubmapOutbox::FrontLoopClosures() {
  while (true) {
    int64_t id = 0;
    {
      absl::MutexLock lock(&mutex_);
      if (loop_closures_.empty()) return nullptr;
      if (loop_closures_.front().bytes != nullptr) return loop_closures_.front().bytes;
      id = loop_closures_.front().id;
    }
    const absl::StatusOr<SharedBytes> bytes = ReadFromFile(id);
    if (bytes.ok()) return *bytes;
    logger_.Error("a batch of loop closures cannot be read: ", bytes.status().ToString());
    PopLoopClosures();
  }
}

void SubmapOutbox::PopLoopClosures() {
  absl::MutexLock lock(&mutex_);
  if (loop_closures_.empty()) return;
  bytes_ -= loop_closures_.front().size;
  ForgetSaved(loop_closures_.front());
  loop_closures_.pop_front();
}

int64_t SubmapOutbox::SavedThrough() const {
  if (path_.empty()) return -1;
  int64_t first_unsaved = position_.next_sequence;
  const auto submap =
      std::lower_bound(submaps_.begin(), submaps_.end(), first_unsaved_id_,
                       [](const OutboxItem& item, int64_t id) { return item.id < id; });
  if (submap != submaps_.end()) first_unsaved = std::min(first_unsaved, submap->sequence);
  const auto blob = blobs_.items().lower_bound(first_unsaved_id_);
  if (blob != blobs_.items().end()) first_unsaved = std::min(first_unsaved, blob->second.sequence);
  return first_unsaved - 1;
}

OutboxLevel SubmapOutbox::Level() const {
  absl::MutexLock lock(&mutex_);
  OutboxLevel level;
  level.submaps = static_cast<int64_t>(submaps_.size()) + reservations_;
  level.loop_closure_batches = static_cast<int64_t>(loop_closures_.size());
  level.blobs = blobs_.size();
  level.bytes = bytes_ + blobs_.bytes();
  level.submaps_acknowledged = submaps_acknowledged_;
  level.clouds_dropped = position_.clouds_dropped;
  level.saved_through = SavedThrough();
  level.synced_through = synced_through_;
  level.disk_ok = disk_ok_;
  return level;
}

bool SubmapOutbox::Empty() const {
  return submaps_.empty() && blobs_.empty() && loop_closures_.empty() && reservations_ == 0;
}

bool SubmapOutbox::AwaitEmpty(absl::Duration timeout) const {
  absl::MutexLock lock(&mutex_);
  mutex_.AwaitWithTimeout(absl::Condition(this, &SubmapOutbox::EmptyOrClosed), timeout);
  return Empty();
}

void SubmapOutbox::Close() {
  absl::MutexLock lock(&mutex_);
  closed_ = true;
}

bool SubmapOutbox::Closed() const {
  absl::MutexLock lock(&mutex_);
  return closed_;
}

}  // namespace overtone
