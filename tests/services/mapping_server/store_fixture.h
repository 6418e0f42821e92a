// SPDX-License-Identifier: Apache-2.0
// A store whose sink writes down what it is told, and calls that wait for their answer.
#ifndef OVERTONE_TESTS_SERVICES_MAPPING_SERVER_STORE_FIXTURE_H_
#define OVERTONE_TESTS_SERVICES_MAPPING_SERVER_STORE_FIXTURE_H_

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "absl/synchronization/notification.h"
#include "gtest/gtest.h"
#include "overtone/proto/conversion/submap_conversion.h"
#include "overtone/services/mapping_server/submap_digest.h"
#include "overtone/services/mapping_server/submap_store/sqlite_submap_store.h"
#include "overtone/tests/services/mapping_server/cloud_fixture.h"
#include "overtone/tests/support/temporary_directory.h"

namespace overtone::testing {

// With the bytes and digest that the upload stream would give it.
inline SubmapRecord RecordOf(const MissionId& mission, Submap submap) {
  std::string bytes = DeterministicBytes(ToProto(submap));
  std::string digest = Sha256(bytes);
  return {mission, std::make_shared<const Submap>(std::move(submap)), std::move(bytes),
          std::move(digest)};
}

inline LoopClosureRecord RecordOf(const LoopClosure& closure) {
  std::string bytes = DeterministicBytes(ToProto(closure));
  std::string digest = Sha256(bytes);
  return {closure, std::move(bytes), std::move(digest)};
}

// Five keyframes.
inline SubmapRecord RecordOf(const MissionId& mission, int64_t sequence,
                             const std::vector<std::string>& blobs = {}) {
  return RecordOf(mission, MakeSubmapWithClouds(sequence, 5 * sequence, 5, blobs));
}

// "anna/run:0 submap", "anna/run:1 two": the cloud's bytes, or "gone"; "finding x"; "closure a-b".
class ToldList {
 public:
  // `store`: asked for the blobs; may be null.
  SubmapStore::Sink Sink(std::unique_ptr<SqliteSubmapStore>* store) {
    SubmapStore::Sink sink;
    sink.on_submap = [this](const MissionId& mission, std::shared_ptr<const Submap> submap) {
      Add(ToString(NodeId{mission, submap->first_index}) + " submap");
    };
    sink.on_loop_closure = [this](const LoopClosure& closure) {
      Add("closure " + ToString(closure.from) + "-" + ToString(closure.to));
    };
    sink.on_finding = [this](const std::string& bytes) { Add("finding " + bytes); };
    sink.on_cloud = [this, store](const MissionId& mission, int64_t index,
                                  const std::string& sha256) {
      const absl::StatusOr<SharedBlob> blob = (*store)->GetBlob(sha256);
      Add(ToString(NodeId{mission, index}) + " " + (blob.ok() ? **blob : "unreadable"));
    };
    sink.on_cloud_gone = [this](const MissionId& mission, int64_t index) {
      Add(ToString(NodeId{mission, index}) + " gone");
    };
    return sink;
  }

  std::vector<std::string> all() const {
    absl::MutexLock lock(&mutex_);
    return told_;
  }
  void Clear() {
    absl::MutexLock lock(&mutex_);
    told_.clear();
  }

 private:
  void Add(std::string what) {
    absl::MutexLock lock(&mutex_);
    told_.push_back(std::move(what));
  }

  mutable absl::Mutex mutex_;
  std::vector<std::string> told_ ABSL_GUARDED_BY(mutex_);
};

template <typename Result, typename Start>
Result WaitFor(Start start) {
  Result result = absl::UnknownError("not done");
  absl::Notification done;
  start([&](Result r) {
    result = std::move(r);
    done.Notify();
  });
  done.WaitForNotification();
  return result;
}

inline absl::StatusOr<AppendResult> Append(SubmapStore& store, SubmapRecord record) {
  return WaitFor<absl::StatusOr<AppendResult>>(
      [&](auto done) { store.Append(std::move(record), done); });
}

inline absl::StatusOr<int> AppendClosures(SubmapStore& store,
                                          std::vector<LoopClosureRecord> records) {
  return WaitFor<absl::StatusOr<int>>(
      [&](auto done) { store.AppendLoopClosures(std::move(records), done); });
}

inline absl::Status AppendFinding(SubmapStore& store, FindingRecord record) {
  return WaitFor<absl::Status>([&](auto done) { store.AppendFinding(std::move(record), done); });
}

inline absl::Status PutBlob(SubmapStore& store, const std::string& blob) {
  return WaitFor<absl::Status>([&](auto done) {
    store.PutBlob(Sha256(blob), std::make_shared<const std::string>(blob), done);
  });
}

inline absl::Status PutSnapshot(SubmapStore& store, std::string bytes) {
  return WaitFor<absl::Status>([&](auto done) { store.PutSnapshot(std::move(bytes), done); });
}

// What was pushed before is done and told, as long as it fits into one batch.
inline void WaitUntilIdle(SubmapStore& store) { EXPECT_TRUE(AppendClosures(store, {}).ok()); }

}  // namespace overtone::testing

#endif  // OVERTONE_TESTS_SERVICES_MAPPING_SERVER_STORE_FIXTURE_H_
