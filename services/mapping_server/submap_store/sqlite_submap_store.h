// SPDX-License-Identifier: Apache-2.0
// The submaps, closures, findings, clouds and the snapshot of one map in an SQLite file: what is
// acknowledged has been synced to disk.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_SQLITE_SUBMAP_STORE_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_SQLITE_SUBMAP_STORE_H_

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "overtone/services/mapping_server/server_options.h"
#include "overtone/services/mapping_server/submap_store.h"
#include "overtone/services/mapping_server/submap_store/loss_list.h"
#include "overtone/services/mapping_server/submap_store/store_file.h"
#include "overtone/services/mapping_server/submap_store/store_index.h"
#include "overtone/services/mapping_server/submap_store/store_writer.h"

namespace overtone {

// Sink and `done` are called on the store's own thread, without a lock that a reading call needs.
// They must not call DeleteMission, and not destroy the store.
class SqliteSubmapStore : public SubmapStore {
 public:
  // ":memory:": lasts as long as the process. A file that is damaged is salvaged, and never
  // refused; with what it holds it starts at Replay, and appends wait until then. An empty one
  // needs none. At most one store may have the file open.
  //   FailedPrecondition   written by a newer version
  //   ResourceExhausted, NotFound   the disk is full or fails; the folder is not there
  static absl::StatusOr<std::unique_ptr<SqliteSubmapStore>> Open(const std::string& path,
                                                                 const ServerLimits& limits,
                                                                 Sink sink,
                                                                 const StoreOptions& options = {});
  // Finishes what waits: the sink and `done` may be called until it returns.
  ~SqliteSubmapStore() override;

  absl::Status Replay() override;
  void Append(SubmapRecord record, std::function<void(absl::StatusOr<AppendResult>)> done) override;
  void AppendLoopClosures(std::vector<LoopClosureRecord> records,
                          std::function<void(absl::StatusOr<int>)> done) override;
  void AppendFinding(FindingRecord record, std::function<void(absl::Status)> done) override;
  void PutBlob(const std::string& sha256, SharedBlob blob,
               std::function<void(absl::Status)> done) override;
  absl::StatusOr<SharedBlob> GetBlob(const std::string& sha256) const override;
  void AbandonBlob(const MissionId& mission, const std::string& sha256) override;
  std::vector<MissingBlob> MissingBlobs(const MissionId& mission, size_t max) const override;
  CloudCounts Clouds() const override { return index_.Clouds(); }
  void PutSnapshot(std::string bytes, std::function<void(absl::Status)> done) override;
  absl::StatusOr<std::string> GetSnapshot() const override;
  absl::Status DeleteMission(const MissionId& mission) override;
  StoreReport Verify() const override;
  absl::Status Backup(const std::string& path) const override;
  void Drain() override {
    if (writer_.started()) writer_.Drain();
  }
  int64_t Backlog() const override { return writer_.Backlog(); }
  UploadState State(const MissionId& mission) const override { return index_.State(mission); }
  std::map<MissionId, UploadState> Missions() const override { return index_.Missions(); }

 private:
  SqliteSubmapStore(std::unique_ptr<LossList> losses, std::unique_ptr<StoreFile> file,
                    const ServerLimits& limits, Sink sink, const StoreOptions& options);

  // Long reads: on a connection of their own.
  template <typename Result>
  absl::StatusOr<Result> WithReader(
      const std::function<absl::StatusOr<Result>(StoreTables&)>& use) const;

  const std::unique_ptr<LossList> losses_;
  const std::unique_ptr<StoreFile> file_;
  mutable StoreIndex index_;
  mutable StoreWriter writer_;  // destroyed first
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_SQLITE_SUBMAP_STORE_H_
