// SPDX-License-Identifier: Apache-2.0
// What the fault tests store, and how they judge what is left: every entry that was acknowledged is
// told again as it was, once, or named in the losses.
#ifndef OVERTONE_TESTS_FAULT_STORE_SAMPLES_H_
#define OVERTONE_TESTS_FAULT_STORE_SAMPLES_H_

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <memory>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "overtone/services/mapping_server/submap_store/sqlite_submap_store.h"
#include "overtone/tests/services/mapping_server/store_fixture.h"

namespace overtone::testing {

// "anna/run 3": that submap's name.
inline std::string SubmapName(const MissionId& mission, int64_t sequence) {
  return ToString(mission) + " " + std::to_string(sequence);
}

// What a store has told, with all its bytes.
class Transcript {
 public:
  SubmapStore::Sink Sink(std::unique_ptr<SqliteSubmapStore>* store) {
    SubmapStore::Sink sink;
    sink.on_submap = [this](const MissionId& mission, std::shared_ptr<const Submap> submap) {
      Tell(SubmapName(mission, submap->sequence) + DeterministicBytes(ToProto(*submap)));
    };
    sink.on_loop_closure = [this](const LoopClosure& closure) {
      Tell("closure " + DeterministicBytes(ToProto(closure)));
    };
    sink.on_finding = [this](const std::string& bytes) { Tell("finding " + bytes); };
    sink.on_cloud = [this, store](const MissionId& mission, int64_t index,
                                  const std::string& sha256) {
      if (*store == nullptr) return;  // it is finishing what waits
      const absl::StatusOr<SharedBlob> blob = (*store)->GetBlob(sha256);
      if (blob.ok()) TellCloud(ToString(NodeId{mission, index}), **blob);
    };
    sink.on_cloud_gone = [](const MissionId&, int64_t) {};
    return sink;
  }

  std::vector<std::string> entries() const {
    absl::MutexLock lock(&mutex_);
    return entries_;
  }
  std::map<std::string, std::string> clouds() const {
    absl::MutexLock lock(&mutex_);
    return clouds_;
  }

 private:
  void Tell(std::string what) {
    absl::MutexLock lock(&mutex_);
    entries_.push_back(std::move(what));
  }
  void TellCloud(const std::string& keyframe, const std::string& bytes) {
    absl::MutexLock lock(&mutex_);
    clouds_[keyframe] = bytes;
  }

  mutable absl::Mutex mutex_;
  std::vector<std::string> entries_ ABSL_GUARDED_BY(mutex_);
  std::map<std::string, std::string> clouds_ ABSL_GUARDED_BY(mutex_);
};

// The log positions that losses name, out of 1 to `last`.
inline std::set<int64_t> NamedPositions(const std::vector<std::string>& losses, int64_t last) {
  static const std::regex one("log entry ([0-9]+)");
  static const std::regex range("log entries (?:after )?([0-9]+) (?:up )?to ([0-9]+)");
  std::set<int64_t> named;
  for (const std::string& loss : losses) {
    std::smatch match;
    if (std::regex_search(loss, match, one)) named.insert(std::stoll(match[1]));
    if (!std::regex_search(loss, match, range)) continue;
    for (int64_t i = std::stoll(match[1]); i <= std::min<int64_t>(last, std::stoll(match[2]));
         ++i) {
      named.insert(i);
    }
  }
  return named;
}

// In memory where there is such a folder: thousands of files, of which no fsync counts.
inline std::string FastFolder() {
  return std::filesystem::is_directory("/dev/shm") ? "/dev/shm" : ::testing::TempDir();
}

// From the environment.
inline int64_t RunsFromEnvironment(const char* variable, int64_t otherwise) {
  const char* text = std::getenv(variable);
  return text == nullptr ? otherwise : std::atoll(text);
}

}  // namespace overtone::testing

#endif  // OVERTONE_TESTS_FAULT_STORE_SAMPLES_H_
