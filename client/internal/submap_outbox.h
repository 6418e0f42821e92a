// SPDX-License-Identifier: Apache-2.0
// What the host has handed over and the server has not yet acknowledged.
#ifndef OVERTONE_CLIENT_INTERNAL_SUBMAP_OUTBOX_H_
#define OVERTONE_CLIENT_INTERNAL_SUBMAP_OUTBOX_H_

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/status/status.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "overtone/client/internal/blob_queue.h"

namespace overtone {

// A submap as it goes over the wire.
struct WaitingSubmap {
  int64_t sequence = 0;
  int64_t first_index = 0;
  SharedBytes bytes;  // serialised overtone.v1.Submap
};

struct OutboxLevel {
  int64_t submaps = 0;
  int64_t loop_closure_batches = 0;
  int64_t blobs = 0;                 // clouds, encoded
  int64_t bytes = 0;                 // of all, serialised
  int64_t submaps_acknowledged = 0;  // removed as such since the beginning
  int64_t clouds_dropped = 0;        // since the beginning: for want of room, or refused for good
};

// Three queues, submaps and the blobs of their clouds by sequence and batches of loop closures by
// order of arrival, that share one bound in bytes. Where it is reached, the blobs of the oldest
// submaps give way to whatever comes, and to nothing else anything. Implementations are thread-safe
// and never make the caller wait for disk or network.
class SubmapOutbox {
 public:
  virtual ~SubmapOutbox() = default;

  // `submap.sequence` follows the last one pushed; `blobs` are its own. ResourceExhausted: full,
  // nothing is kept. Ok: the submap is; of its blobs those for which there is room.
  virtual absl::Status PushSubmap(WaitingSubmap submap, std::vector<WaitingBlob> blobs) = 0;

  // The highest sequence ever pushed; -1: none.
  virtual int64_t LastSequence() const = 0;

  // The first waiting submap with at least this sequence.
  virtual std::optional<WaitingSubmap> FirstSubmapFrom(int64_t sequence) const = 0;

  // Forgets acknowledged submaps: all up to and including `sequence`.
  virtual void RemoveSubmapsThrough(int64_t sequence) = 0;

  // Forgets submaps that cannot be sent any more: `sequence` and all that follow it, with their
  // blobs. Returns them in order.
  virtual std::vector<WaitingSubmap> RemoveSubmapsFrom(int64_t sequence) = 0;

  virtual SharedBytes FindBlob(const std::string& sha256) const = 0;  // null: not there (any more)
  // The server has it.
  virtual void RemoveBlob(const std::string& sha256) = 0;
  // The server will not have it: counts as dropped.
  virtual void DropBlob(const std::string& sha256) = 0;
  // The server lacks none of the submaps up to and including `sequence`.
  virtual void RemoveBlobsThrough(int64_t sequence) = 0;

  // `batch` is a serialised overtone.v1.AddLoopClosuresRequest. ResourceExhausted: full, nothing is
  // kept.
  virtual absl::Status PushLoopClosures(SharedBytes batch) = 0;
  virtual SharedBytes FrontLoopClosures() const = 0;  // null: none
  virtual void PopLoopClosures() = 0;

  virtual OutboxLevel Level() const = 0;

  // False: something still waits after `timeout`.
  virtual bool AwaitEmpty(absl::Duration timeout) const = 0;
};

// Loses what waits when the process ends.
class InMemoryOutbox final : public SubmapOutbox {
 public:
  explicit InMemoryOutbox(int64_t capacity_bytes) : capacity_bytes_(capacity_bytes) {}

  absl::Status PushSubmap(WaitingSubmap submap, std::vector<WaitingBlob> blobs) override;
  int64_t LastSequence() const override;
  std::optional<WaitingSubmap> FirstSubmapFrom(int64_t sequence) const override;
  void RemoveSubmapsThrough(int64_t sequence) override;
  std::vector<WaitingSubmap> RemoveSubmapsFrom(int64_t sequence) override;
  SharedBytes FindBlob(const std::string& sha256) const override;
  void RemoveBlob(const std::string& sha256) override;
  void DropBlob(const std::string& sha256) override;
  void RemoveBlobsThrough(int64_t sequence) override;
  absl::Status PushLoopClosures(SharedBytes batch) override;
  SharedBytes FrontLoopClosures() const override;
  void PopLoopClosures() override;
  OutboxLevel Level() const override;
  bool AwaitEmpty(absl::Duration timeout) const override;

 private:
  absl::Status Reserve(int64_t bytes) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void PushBlob(WaitingBlob blob) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // Drops the oldest blobs until there is room for `bytes`, or there are no more.
  void MakeRoom(int64_t bytes) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  bool Empty() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    return submaps_.empty() && blobs_.empty() && loop_closures_.empty();
  }

  const int64_t capacity_bytes_;
  mutable absl::Mutex mutex_;
  std::deque<WaitingSubmap> submaps_ ABSL_GUARDED_BY(mutex_);  // consecutive sequences
  std::deque<SharedBytes> loop_closures_ ABSL_GUARDED_BY(mutex_);
  int64_t last_sequence_ ABSL_GUARDED_BY(mutex_) = -1;
  BlobQueue blobs_ ABSL_GUARDED_BY(mutex_);
  int64_t bytes_ ABSL_GUARDED_BY(mutex_) = 0;  // without blobs
  int64_t clouds_dropped_ ABSL_GUARDED_BY(mutex_) = 0;
  int64_t submaps_acknowledged_ ABSL_GUARDED_BY(mutex_) = 0;
};

}  // namespace overtone

#endif  // OVERTONE_CLIENT_INTERNAL_SUBMAP_OUTBOX_H_
