// SPDX-License-Identifier: Apache-2.0
// How the outbox brings its file up to date.
#include <algorithm>
#include <filesystem>
#include <limits>
#include <system_error>
#include <utility>

#include "absl/strings/str_cat.h"
#include "overtone/client/internal/submap_outbox.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {
namespace {

using Kind = OutboxItem::Kind;

// Of one transaction, unless one submap with its clouds is larger: what a checkpoint can do in
// between keeps the write-ahead log small.
constexpr int64_t kBatchBytes = 4 << 20;

bool ById(const OutboxItem& item, int64_t id) { return item.id < id; }

}  // namespace

absl::Status SubmapOutbox::Flush() {
  if (path_.empty()) return absl::OkStatus();
  absl::MutexLock lock(&file_mutex_);
  return FlushLocked();
}

absl::Status SubmapOutbox::Sync() {
  if (path_.empty()) return absl::OkStatus();
  absl::MutexLock lock(&file_mutex_);
  RETURN_IF_ERROR(FlushLocked());
  if (!unsynced_) return absl::OkStatus();
  const int64_t saved_through = Level().saved_through;
  const absl::Status status = file_->Sync();
  TellDisk(status);
  RETURN_IF_ERROR(status);
  unsynced_ = false;
  absl::MutexLock index_lock(&mutex_);
  // What was acknowledged or refused meanwhile does no harm: it needs no file any more.
  synced_through_ = saved_through;
  return absl::OkStatus();
}

absl::Status SubmapOutbox::FlushLocked() {
  if (file_ == nullptr) {
    const absl::Status status = OpenAgain();
    TellDisk(status);
    RETURN_IF_ERROR(status);
  }
  while (std::optional<Batch> batch = NextBatch()) {
    absl::Status status = file_->Write(batch->removed, batch->added, batch->position);
    if (status.ok()) {
      unsynced_ = true;
      MarkSaved(*batch);
    } else {
      absl::MutexLock lock(&mutex_);
      removed_.insert(removed_.end(), batch->removed.begin(), batch->removed.end());
    }
    if (absl::IsDataLoss(status)) status = Recover();
    TellDisk(status);
    RETURN_IF_ERROR(status);
  }
  TellDisk(absl::OkStatus());
  return absl::OkStatus();
}

std::optional<SubmapOutbox::Batch> SubmapOutbox::NextBatch() {
  absl::MutexLock lock(&mutex_);
  Batch batch;
  int64_t bytes = 0;
  auto submap = std::lower_bound(submaps_.begin(), submaps_.end(), first_unsaved_id_, ById);
  auto closures =
      std::lower_bound(loop_closures_.begin(), loop_closures_.end(), first_unsaved_id_, ById);
  auto blob = blobs_.items().lower_bound(first_unsaved_id_);
  while (true) {
    constexpr int64_t kNone = std::numeric_limits<int64_t>::max();
    const int64_t submap_id = submap == submaps_.end() ? kNone : submap->id;
    const int64_t closures_id = closures == loop_closures_.end() ? kNone : closures->id;
    const int64_t blob_id = blob == blobs_.items().end() ? kNone : blob->first;
    const int64_t oldest = std::min({submap_id, closures_id, blob_id});
    // A submap and its clouds go together.
    if (oldest == kNone || (bytes >= kBatchBytes && oldest != blob_id)) break;
    batch.added.push_back(oldest == submap_id     ? *submap++
                          : oldest == closures_id ? *closures++
                                                  : (blob++)->second);
    bytes += batch.added.back().size;
  }
  batch.position = PositionAfter(batch);
  batch.removed.swap(removed_);
  const bool up_to_date =
      batch.added.empty() && batch.removed.empty() && batch.position == file_position_;
  return up_to_date ? std::nullopt : std::optional<Batch>(std::move(batch));
}

// The file's position counts what is in the file: of two submaps not saved yet, it goes on after
// the first when the batch ends there.
OutboxPosition SubmapOutbox::PositionAfter(const Batch& batch) const {
  const auto is_submap = [](const OutboxItem& item) { return item.kind == Kind::kSubmap; };
  const auto last = std::find_if(batch.added.rbegin(), batch.added.rend(), is_submap);
  OutboxPosition position = file_position_;
  if (last != batch.added.rend()) {
    position = {last->sequence + 1, last->first_index + last->num_keyframes, last->last_stamp_ns};
  }
  const bool more = !submaps_.empty() && !submaps_.back().saved &&
                    (last == batch.added.rend() || submaps_.back().id != last->id);
  if (!more) position = position_;
  position.clouds_dropped = position_.clouds_dropped;
  return position;
}

void SubmapOutbox::MarkSaved(const Batch& batch) {
  absl::MutexLock lock(&mutex_);
  file_position_ = batch.position;
  for (const OutboxItem& item : batch.added) {
    first_unsaved_id_ = item.id + 1;
    // What was acknowledged or dropped meanwhile goes from the file again.
    if (!MarkSaved(item)) removed_.push_back(item.id);
  }
}

// False: it does not wait any more.
bool SubmapOutbox::MarkSaved(const OutboxItem& item) {
  if (item.kind == Kind::kBlob) return blobs_.MarkSaved(item.id);
  std::deque<OutboxItem>& queue = QueueOf(item.kind);
  const auto it = std::lower_bound(queue.begin(), queue.end(), item.id, ById);
  if (it == queue.end() || it->id != item.id) return false;
  it->saved = true;
  it->bytes = nullptr;
  return true;
}

// Where the file could not be opened before. What it may hold is of an earlier life.
absl::Status SubmapOutbox::OpenAgain() {
  ASSIGN_OR_RETURN(OpenedOutbox opened, OpenOutbox(path_));
  file_ = std::move(opened.file);
  absl::MutexLock lock(&mutex_);
  for (const OutboxItem& item : opened.content.items) removed_.push_back(item.id);
  if (!opened.content.items.empty()) {
    next_id_ = std::max(next_id_, opened.content.items.back().id + 1);
  }
  file_position_ = opened.content.position;
  return absl::OkStatus();
}

absl::Status SubmapOutbox::Recover() {
  file_ = nullptr;
  absl::StatusOr<OpenedOutbox> opened = RecoverOutbox(path_);
  if (!opened.ok()) {
    Reconcile({});
    return opened.status();
  }
  logger_.Error("the outbox is damaged; it is now ", opened->set_aside);
  file_ = std::move(opened->file);
  Reconcile(opened->content);
  return absl::OkStatus();
}

// Forgets what was saved and is not in `content`.
void SubmapOutbox::Reconcile(const OutboxContent& content) {
  const auto is_lost = [&](const OutboxItem& item) {
    const auto it = std::lower_bound(content.items.begin(), content.items.end(), item.id, ById);
    return item.saved && (it == content.items.end() || it->id != item.id);
  };
  int64_t lost = 0;
  int64_t lost_blobs = 0;
  {
    absl::MutexLock lock(&mutex_);
    file_position_ = content.position;
    for (std::deque<OutboxItem>* queue : {&submaps_, &loop_closures_}) {
      for (const OutboxItem& item : *queue) {
        if (!is_lost(item)) continue;
        bytes_ -= item.size;
        ++lost;
      }
      queue->erase(std::remove_if(queue->begin(), queue->end(), is_lost), queue->end());
    }
    lost_blobs = static_cast<int64_t>(blobs_.RemoveIf(is_lost).size());
    position_.clouds_dropped += lost_blobs;
  }
  if (lost + lost_blobs == 0) return;
  logger_.Error("of the outbox ", lost, " submaps and batches of loop closures and ", lost_blobs,
                " clouds are lost");
}

void SubmapOutbox::TellDisk(const absl::Status& status) {
  {
    absl::MutexLock lock(&mutex_);
    if (std::exchange(disk_ok_, status.ok()) == status.ok()) return;
  }
  if (status.ok()) {
    logger_.Info("the outbox is on disk again");
  } else {
    logger_.Warning("the outbox goes on in memory: ", status.ToString());
  }
}

void SubmapOutbox::RemoveFile() {
  if (path_.empty()) return;
  absl::MutexLock lock(&file_mutex_);
  std::error_code error;  // then it is found again at the next start
  std::filesystem::remove(path_, error);
  file_ = nullptr;
  std::filesystem::remove(path_ + "-wal", error);
}

}  // namespace overtone
