// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/internal/submap_intake.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "overtone/client/internal/cloud_encoding.h"
#include "overtone/client/internal/exception_guard.h"

namespace overtone {
namespace {

// Of submaps that come in one burst, so many bytes share a transaction.
constexpr int64_t kTransactionBytes = 4 << 20;

int64_t RawBytes(const std::vector<KeyframeCloud>& clouds) {
  int64_t bytes = 0;
  for (const KeyframeCloud& cloud : clouds) {
    bytes += static_cast<int64_t>(cloud.cloud->points.size() * sizeof(cloud.cloud->points[0]) +
                                  cloud.cloud->intensities.size() * sizeof(float));
  }
  return bytes;
}

}  // namespace

SubmapIntake::SubmapIntake(SubmapOutbox* outbox, CloudCodecOptions clouds,
                           absl::Duration sync_interval, Logger logger,
                           std::function<void()> on_stored)
    : outbox_(outbox),
      codec_(clouds),
      sync_interval_(sync_interval),
      logger_(std::move(logger)),
      on_stored_(std::move(on_stored)),
      next_sync_(Clock::now()) {}

void SubmapIntake::Start() {
  thread_ = std::thread([this] { Run(); });
}

void SubmapIntake::Stop() {
  {
    absl::MutexLock lock(&mutex_);
    stopping_ = true;
    if (!outbox_->HasFile()) {
      for (const Item& item : queue_) Drop(item);
      queue_.clear();
    }
  }
  if (thread_.joinable()) thread_.join();
}

void SubmapIntake::Push(v1::Submap message, std::vector<KeyframeCloud> clouds, int64_t reserved) {
  Item item{std::move(message), std::move(clouds), reserved};
  item.raw_bytes = RawBytes(item.clouds);
  absl::MutexLock lock(&mutex_);
  for (Item& older : queue_) {
    if (raw_bytes_ + item.raw_bytes <= kMaxRawCloudBytes) break;
    DropClouds(older);
  }
  raw_bytes_ += item.raw_bytes;
  clouds_waiting_ += static_cast<int64_t>(item.clouds.size());
  queue_.push_back(std::move(item));
  ++handed_over_;
}

void SubmapIntake::Notify() {
  absl::MutexLock lock(&mutex_);
  notified_ = true;
  ++handed_over_;
}

std::vector<int64_t> SubmapIntake::DropFrom(int64_t sequence) {
  absl::MutexLock lock(&mutex_);
  std::vector<int64_t> dropped;
  if (storing_ >= sequence && !storing_dropped_) {
    storing_dropped_ = true;
    dropped.push_back(storing_);
  }
  const auto first = std::find_if(queue_.begin(), queue_.end(), [&](const Item& item) {
    return item.message.sequence() >= sequence;
  });
  for (auto it = first; it != queue_.end(); ++it) {
    dropped.push_back(it->message.sequence());
    Drop(*it);
  }
  queue_.erase(first, queue_.end());
  return dropped;
}

bool SubmapIntake::AwaitStored(absl::Duration timeout) const {
  absl::MutexLock lock(&mutex_);
  const int64_t all = handed_over_;
  const auto stored = [&] { return mutex_.AssertHeld(), stored_ >= all; };
  return mutex_.AwaitWithTimeout(absl::Condition(&stored), timeout);
}

int64_t SubmapIntake::clouds_waiting() const {
  absl::MutexLock lock(&mutex_);
  return clouds_waiting_;
}

void SubmapIntake::Run() {
  while (true) {
    const absl::Status status =
        GuardExceptions("intake", [this] { return Work(), absl::OkStatus(); });
    if (!status.ok()) logger_.Error(status.ToString());
    absl::MutexLock lock(&mutex_);
    if (stopping_ && queue_.empty()) return;
  }
}

void SubmapIntake::Work() {
  Item item;
  if (TakeNext(item)) Store(std::move(item));
  {
    absl::MutexLock lock(&mutex_);
    if (!queue_.empty() && unwritten_bytes_ < kTransactionBytes) return;
    if (stopping_) next_sync_ = Clock::now();
  }
  WriteToDisk();
  on_stored_();
}

bool SubmapIntake::TakeNext(Item& item) {
  const auto has_work = [this] {
    mutex_.AssertHeld();
    return stopping_ || notified_ || !queue_.empty();
  };
  absl::MutexLock lock(&mutex_);
  mutex_.AwaitWithTimeout(absl::Condition(&has_work), absl::FromChrono(next_sync_ - Clock::now()));
  notified_ = false;
  if (queue_.empty()) return false;
  item = std::move(queue_.front());
  queue_.pop_front();
  storing_ = item.message.sequence();
  storing_dropped_ = false;
  return true;
}

void SubmapIntake::Store(Item item) {
  EncodedClouds encoded = EncodeClouds(item.clouds, codec_, item.message);
  for (const absl::Status& failure : encoded.failures) {
    logger_.Warning("submap ", item.message.sequence(),
                    ": a cloud cannot be encoded: ", failure.ToString());
  }
  WaitingSubmap submap;
  submap.sequence = item.message.sequence();
  submap.first_index = item.message.first_index();
  submap.num_keyframes = item.message.keyframes_size();
  submap.last_stamp_ns = item.message.keyframes(item.message.keyframes_size() - 1).stamp_ns();
  submap.bytes = std::make_shared<const std::string>(item.message.SerializeAsString());
  unwritten_bytes_ += item.reserved;
  for (const WaitingBlob& blob : encoded.blobs) unwritten_bytes_ += blob.bytes->size();

  absl::MutexLock lock(&mutex_);
  storing_ = -1;
  raw_bytes_ -= item.raw_bytes;
  clouds_waiting_ -= static_cast<int64_t>(item.clouds.size());
  if (storing_dropped_) {
    outbox_->Release(item.reserved);
    return;
  }
  outbox_->CountDroppedClouds(static_cast<int64_t>(encoded.failures.size()));
  const absl::Status status =
      outbox_->PushSubmap(std::move(submap), std::move(encoded.blobs), item.reserved);
  if (!status.ok()) logger_.Error("a submap has no room after all: ", status.ToString());
}

// Whatever was handed over by now and is not in the queue is in the outbox.
void SubmapIntake::WriteToDisk() {
  int64_t through = 0;
  {
    absl::MutexLock lock(&mutex_);
    through = handed_over_ - static_cast<int64_t>(queue_.size());
  }
  const bool sync_is_due = Clock::now() >= next_sync_;
  const absl::Status status = sync_is_due ? outbox_->Sync() : outbox_->Flush();
  if (sync_is_due) next_sync_ = Clock::now() + absl::ToChronoNanoseconds(sync_interval_);
  unwritten_bytes_ = 0;
  if (!status.ok()) return;
  absl::MutexLock lock(&mutex_);
  stored_ = std::max(stored_, through);
}

void SubmapIntake::DropClouds(Item& item) {
  outbox_->CountDroppedClouds(static_cast<int64_t>(item.clouds.size()));
  raw_bytes_ -= item.raw_bytes;
  clouds_waiting_ -= static_cast<int64_t>(item.clouds.size());
  item.raw_bytes = 0;
  item.clouds.clear();
  item.message.clear_clouds();
}

void SubmapIntake::Drop(const Item& item) {
  raw_bytes_ -= item.raw_bytes;
  clouds_waiting_ -= static_cast<int64_t>(item.clouds.size());
  outbox_->Release(item.reserved);
}

}  // namespace overtone
