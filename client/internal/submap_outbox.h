// SPDX-License-Identifier: Apache-2.0
// What the host has handed over and the server has not yet acknowledged.
#ifndef OVERTONE_CLIENT_INTERNAL_SUBMAP_OUTBOX_H_
#define OVERTONE_CLIENT_INTERNAL_SUBMAP_OUTBOX_H_

#include <cstdint>
#include <deque>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "overtone/client/internal/blob_queue.h"
#include "overtone/client/internal/logger.h"
#include "overtone/client/internal/outbox_file.h"
#include "overtone/client/internal/outbox_item.h"
#include "overtone/client/internal/outbox_recovery.h"

namespace overtone {

// A submap as it goes over the wire.
struct WaitingSubmap {
  int64_t sequence = 0;
  int64_t first_index = 0;
  SharedBytes bytes;  // serialised overtone.v1.Submap
  int64_t num_keyframes = 0;
  int64_t last_stamp_ns = std::numeric_limits<int64_t>::min();
};

struct SubmapHead {
  int64_t sequence = 0;
  int64_t first_index = 0;
  int64_t size = 0;  // bytes, serialised
};

struct WaitingBlob {
  int64_t sequence = 0;  // of its submap
  std::string sha256;
  SharedBytes bytes;
};

struct OutboxLevel {
  int64_t submaps = 0;
  int64_t loop_closure_batches = 0;
  int64_t blobs = 0;                 // clouds, encoded
  int64_t bytes = 0;                 // of all, serialised
  int64_t submaps_acknowledged = 0;  // removed as such since the process began
  int64_t clouds_dropped = 0;        // of this mission: no room, not encodable, refused for good
  int64_t saved_through = -1;        // sequence: it and all before are in the file, or acknowledged
  int64_t synced_through = -1;       // sequence: the same after a loss of power
  bool disk_ok = true;               // false: what comes stays in memory
};

// Three queues, submaps and the blobs of their clouds by sequence and batches of loop closures by
// order of arrival, that share one bound in bytes. Where it is reached, the blobs of the oldest
// submaps give way to whatever comes, and to nothing else anything.
//
// What is pushed is in memory until Flush has written it to the file; only what it says about the
// items stays there. Without a file, or while the disk fails, everything stays in memory, within
// the same bound. A submap is not handed out before it is in the file: the server must not know of
// one that a restarted host would hand over with other content.
//
// Thread-safe. Only Flush, Sync, ReadSubmap and FindBlob touch the disk, and no other method waits
// for them.
class SubmapOutbox {
 public:
  // In memory: loses what waits when the process ends.
  explicit SubmapOutbox(int64_t capacity_bytes);
  // Goes on with what is in the file. Errors as OpenOutbox.
  static absl::StatusOr<std::unique_ptr<SubmapOutbox>> Open(int64_t capacity_bytes,
                                                            const std::string& path, Logger logger);

  bool HasFile() const { return !path_.empty(); }

  // Room for a submap that is being prepared. ResourceExhausted: full.
  absl::Status Reserve(int64_t bytes);
  void Release(int64_t bytes);

  // `submap.sequence` follows the last one pushed; `blobs` are its own; `reserved` bytes are given
  // back. ResourceExhausted: full, nothing is kept. Ok: the submap is; of its blobs those for which
  // there is room.
  absl::Status PushSubmap(WaitingSubmap submap, std::vector<WaitingBlob> blobs,
                          int64_t reserved = 0);
  // Clouds that could not even be encoded.
  void CountDroppedClouds(int64_t count);

  // Where the next submap begins.
  OutboxPosition Position() const;
  // The highest sequence pushed; -1: none.
  int64_t LastSequence() const { return Position().next_sequence - 1; }

  // The first waiting submap with at least this sequence that may be sent.
  std::optional<SubmapHead> FirstSubmapFrom(int64_t sequence) const;
  // NotFound: it does not wait (any more). DataLoss: damaged, and now gone. Other errors: the disk
  // cannot be read now.
  absl::StatusOr<SharedBytes> ReadSubmap(int64_t sequence);

  // Forgets acknowledged submaps: all up to and including `sequence`.
  void RemoveSubmapsThrough(int64_t sequence);

  // Forgets submaps that cannot be sent any more: `sequence` and all that follow it, with their
  // blobs. Returns them in order; the position is then that of the first of them.
  std::vector<SubmapHead> RemoveSubmapsFrom(int64_t sequence);

  std::optional<int64_t> BlobSize(const std::string& sha256) const;  // none: not there (any more)
  // Null: not there (any more); one that cannot be read is dropped.
  SharedBytes FindBlob(const std::string& sha256);
  // The server has it.
  void RemoveBlob(const std::string& sha256);
  // The server will not have it: counts as dropped.
  void DropBlob(const std::string& sha256);
  // The server lacks none of the submaps up to and including `sequence`.
  void RemoveBlobsThrough(int64_t sequence);

  // `batch` is a serialised overtone.v1.AddLoopClosuresRequest. ResourceExhausted: full, nothing is
  // kept.
  absl::Status PushLoopClosures(SharedBytes batch);
  // Null: none. One that is damaged is skipped.
  SharedBytes FrontLoopClosures();
  void PopLoopClosures();

  // Brings the file up to date. Not ok: the disk fails, and what is not written stays in memory
  // until a later call succeeds. Told in the log once for each change.
  absl::Status Flush();
  // Flush, and what is in the file then also survives a loss of power.
  absl::Status Sync();

  OutboxLevel Level() const;

  // False: something still waits after `timeout`, or Close was called.
  bool AwaitEmpty(absl::Duration timeout) const;
  // Wakes all who wait in AwaitEmpty, for good.
  void Close();
  bool Closed() const;
  // Removes the file. What still waits is lost when the outbox goes.
  void RemoveFile();

 private:
  struct Batch {
    std::vector<int64_t> removed;
    std::vector<OutboxItem> added;
    OutboxPosition position;
  };

  SubmapOutbox(int64_t capacity_bytes, std::string path, OpenedOutbox opened, Logger logger);

  void Adopt(OutboxContent content) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  absl::Status ReserveLocked(int64_t bytes) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void PushBlob(WaitingBlob blob) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  OutboxItem NewItem(OutboxItem::Kind kind, SharedBytes bytes)
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // Drops the oldest blobs until there is room for `bytes`, or there are no more.
  void MakeRoom(int64_t bytes) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void ForgetSaved(const OutboxItem& item) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void ForgetSaved(const std::vector<OutboxItem>& items) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  bool MaySend(const OutboxItem& submap) const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  bool Empty() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  bool EmptyOrClosed() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) { return closed_ || Empty(); }
  int64_t SavedThrough() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  std::deque<OutboxItem>::iterator FindSubmap(int64_t sequence)
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // Of submaps or of loop closures.
  std::deque<OutboxItem>& QueueOf(OutboxItem::Kind kind) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  bool MarkSaved(const OutboxItem& item) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  absl::StatusOr<SharedBytes> ReadFromFile(int64_t id) ABSL_LOCKS_EXCLUDED(mutex_, file_mutex_);
  absl::Status FlushLocked() ABSL_EXCLUSIVE_LOCKS_REQUIRED(file_mutex_);
  absl::Status OpenAgain() ABSL_EXCLUSIVE_LOCKS_REQUIRED(file_mutex_);
  absl::Status Recover() ABSL_EXCLUSIVE_LOCKS_REQUIRED(file_mutex_);
  // None: the file is up to date.
  std::optional<Batch> NextBatch() ABSL_LOCKS_EXCLUDED(mutex_);
  OutboxPosition PositionAfter(const Batch& batch) const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void Reconcile(const OutboxContent& content) ABSL_LOCKS_EXCLUDED(mutex_);
  void MarkSaved(const Batch& batch) ABSL_LOCKS_EXCLUDED(mutex_);
  void TellDisk(const absl::Status& status) ABSL_LOCKS_EXCLUDED(mutex_);

  const int64_t capacity_bytes_;
  const std::string path_;  // empty: no file
  const Logger logger_;

  // Held during disk accesses; before mutex_ where both are needed.
  absl::Mutex file_mutex_;
  std::unique_ptr<OutboxFile> file_ ABSL_GUARDED_BY(file_mutex_);
  bool unsynced_ ABSL_GUARDED_BY(file_mutex_) = true;

  mutable absl::Mutex mutex_;
  std::deque<OutboxItem> submaps_ ABSL_GUARDED_BY(mutex_);  // increasing ids and sequences
  std::deque<OutboxItem> loop_closures_ ABSL_GUARDED_BY(mutex_);
  BlobQueue blobs_ ABSL_GUARDED_BY(mutex_);
  OutboxPosition position_ ABSL_GUARDED_BY(mutex_);
  OutboxPosition file_position_ ABSL_GUARDED_BY(mutex_);
  std::vector<int64_t> removed_ ABSL_GUARDED_BY(mutex_);  // ids that the file still holds
  int64_t next_id_ ABSL_GUARDED_BY(mutex_) = 1;
  // What waits below this id is in the file, and what waits from it on is not: batches take
  // everything in the order of arrival.
  int64_t first_unsaved_id_ ABSL_GUARDED_BY(mutex_) = 1;
  int64_t bytes_ ABSL_GUARDED_BY(mutex_) = 0;  // without blobs, with what is reserved
  int64_t reservations_ ABSL_GUARDED_BY(mutex_) = 0;
  int64_t submaps_acknowledged_ ABSL_GUARDED_BY(mutex_) = 0;
  int64_t synced_through_ ABSL_GUARDED_BY(mutex_) = -1;
  bool disk_ok_ ABSL_GUARDED_BY(mutex_) = true;
  bool closed_ ABSL_GUARDED_BY(mutex_) = false;
};

}  // namespace overtone

#endif  // OVERTONE_CLIENT_INTERNAL_SUBMAP_OUTBOX_H_
