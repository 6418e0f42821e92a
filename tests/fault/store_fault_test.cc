// SPDX-License-Identifier: Apache-2.0
// The disk fails under a running store: power cuts at any operation, errors and no space at any
// write or sync. OVERTONE_TEST_FAULT_RUNS: how many power cuts.
#include <filesystem>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/tests/fault/store_samples.h"
#include "overtone/tests/support/fault_table.h"
#include "overtone/tests/support/fault_vfs.h"
#include "spdlog/spdlog.h"
#include "sqlite3.h"

namespace overtone {
namespace {

using ::testing::IsEmpty;
using testing::RecordOf;

const std::vector<MissionId> kMissions = {{"anna", "run"}, {"bert", "run"}, {"carl", "run"}};
constexpr int64_t kSubmaps = 8;  // of each mission

class StoreFaultTest : public ::testing::Test {
 protected:
  StoreFaultTest() {
    spdlog::set_level(spdlog::level::off);
    FaultVfs::Instance().Reset();
    options_.vfs = FaultVfs::name();
    options_.checkpoint_pages_when_idle = 20;
    options_.checkpoint_pages = 40;
  }
  ~StoreFaultTest() override { FaultVfs::Instance().Reset(); }

  // What a store has acknowledged and told until its end.
  struct Session {
    std::map<MissionId, int64_t> acknowledged;  // submaps
    std::set<std::string> blobs;
    int64_t findings = 0;
    testing::Transcript transcript;
  };

  static std::string Blob(const MissionId& mission, int64_t sequence) {
    return ToString(mission) + std::to_string(sequence) + std::string(1000, 'b');
  }

  absl::StatusOr<std::unique_ptr<SqliteSubmapStore>> Open(const std::string& path,
                                                          Session& session) {
    ASSIGN_OR_RETURN(
        auto store,
        SqliteSubmapStore::Open(path, ServerLimits(), session.transcript.Sink(&store_), options_));
    return store;
  }

  // Everything goes out without waiting; answers are noted as they come.
  void UploadAll(Session& session) {
    for (int64_t sequence = 0; sequence < kSubmaps; ++sequence) {
      for (const MissionId& mission : kMissions) {
        store_->Append(RecordOf(mission, sequence, {Blob(mission, sequence)}),
                       [&session, mission](const absl::StatusOr<AppendResult>& result) {
                         if (result.ok()) {
                           session.acknowledged[mission] = result->state.next_sequence;
                         }
                       });
      }
      store_->AppendFinding({"finding " + std::to_string(sequence), {}},
                            [&](const absl::Status& status) { session.findings += status.ok(); });
      if (sequence < 2) continue;
      // One that is asked for in the meantime, and a snapshot now and then.
      testing::WaitFor<absl::StatusOr<int>>(
          [&](auto done) { store_->AppendLoopClosures({}, done); })
          .status()
          .IgnoreError();
      for (const MissionId& mission : kMissions) {
        const std::string blob = Blob(mission, sequence - 2);
        store_->PutBlob(Sha256(blob), std::make_shared<const std::string>(blob),
                        [&session, blob](const absl::Status& status) {
                          if (status.ok()) session.blobs.insert(blob);
                        });
      }
      store_->PutSnapshot(std::string(5000, 's'), [](const absl::Status&) {});
    }
  }

  // All that was acknowledged, each submap once, in order, as it was.
  void ExpectAll(const Session& before, const testing::Transcript& after) {
    std::map<MissionId, int64_t> told;
    int64_t findings = 0;
    for (const std::string& entry : after.entries()) {
      findings += entry.compare(0, 8, "finding ") == 0;
      for (const MissionId& mission : kMissions) {
        const int64_t next = told[mission];
        const std::string expected = testing::SubmapName(mission, next) +
                                     RecordOf(mission, next, {Blob(mission, next)}).bytes;
        told[mission] += entry == expected;
      }
    }
    int64_t submaps = 0;
    for (const MissionId& mission : kMissions) {
      const auto acknowledged = before.acknowledged.find(mission);
      if (acknowledged != before.acknowledged.end()) {
        EXPECT_GE(told[mission], acknowledged->second) << ToString(mission);
      }
      submaps += told[mission];
    }
    EXPECT_GE(findings, before.findings);
    // Nothing twice, nothing else.
    EXPECT_EQ(static_cast<int64_t>(after.entries().size()), submaps + findings);
    for (const std::string& blob : before.blobs) {
      const absl::StatusOr<SharedBlob> stored = store_->GetBlob(Sha256(blob));
      ASSERT_TRUE(stored.ok()) << stored.status();
      EXPECT_EQ(**stored, blob);
    }
  }

  StoreOptions options_;
  TemporaryDirectory folder_{testing::FastFolder()};
  std::unique_ptr<SqliteSubmapStore> store_;
};

TEST_F(StoreFaultTest, APowerCutAtAnyMomentLosesNothingThatWasAcknowledged) {
  const int64_t runs = testing::RunsFromEnvironment("OVERTONE_TEST_FAULT_RUNS", 300);
  FaultVfs& disk = FaultVfs::Instance();
  std::mt19937 random(20260101);
  int64_t acknowledged = 0, cut_at_opening = 0, whole = 0;
  for (int64_t run = 0; run < runs && !HasFailure(); ++run) {
    SCOPED_TRACE(run);
    const std::string path = folder_.File("map" + std::to_string(run));
    disk.Reset();
    Session before;
    disk.CutPowerAfter(std::uniform_int_distribution<int64_t>(0, 220)(random));
    auto opened = Open(path, before);
    if (opened.ok()) {
      store_ = *std::move(opened);
      UploadAll(before);
      whole += !disk.power_is_off();
      store_.reset();
    } else {
      ++cut_at_opening;
    }
    const std::string survivor = folder_.File("survivor" + std::to_string(run));
    disk.WriteSurvivors(path, survivor, random);
    std::error_code error;
    // The mark is never synced: it is as it was, or it is not there.
    if (random() % 2 == 0) std::filesystem::copy_file(path + "-mark", survivor + "-mark", error);
    disk.Reset();
    for (const auto& [mission, submaps] : before.acknowledged) acknowledged += submaps;

    Session after;
    auto reopened = Open(survivor, after);
    ASSERT_TRUE(reopened.ok()) << reopened.status();
    store_ = *std::move(reopened);
    ASSERT_TRUE(store_->Replay().ok());
    ExpectAll(before, after.transcript);
    // A cut is no damage.
    if (!before.acknowledged.empty()) {
      EXPECT_THAT(store_->Verify().losses, IsEmpty());
    }
    store_.reset();
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) {
      std::filesystem::remove(entry.path());
    }
  }
  EXPECT_GT(acknowledged, runs);
  FaultRow(
      "store", absl::StrCat(runs, " power cuts, unsynced writes dropped"),
      absl::StrCat(cut_at_opening, " while opening, ", whole,
                   " after the end; submaps acknowledged ", acknowledged, ", lost 0, doubled 0"));
}

// One error at each operation in turn: the batch is refused, the same again is taken.
TEST_F(StoreFaultTest, AnErrorAtAnyOperationIsOvercomeWithoutRestart) {
  FaultVfs& disk = FaultVfs::Instance();
  int64_t refused = 0, faults = 0;
  for (const int code : {SQLITE_FULL, SQLITE_IOERR_WRITE, SQLITE_IOERR_FSYNC}) {
    for (int64_t operation = 0; operation < 80 && !HasFailure(); ++operation) {
      SCOPED_TRACE(operation);
      const std::string path = folder_.File("map.db");
      disk.Reset();
      Session session;
      store_ = *Open(path, session);
      disk.FailAfter(operation, code, /*times=*/1);
      ++faults;
      for (int64_t sequence = 0; sequence < 6; ++sequence) {
        const MissionId& mission = kMissions[0];
        const SubmapRecord record = RecordOf(mission, sequence, {Blob(mission, sequence)});
        absl::StatusOr<AppendResult> result = testing::Append(*store_, record);
        if (!result.ok()) {
          ++refused;
          EXPECT_EQ(result.status().code(), absl::StatusCode::kResourceExhausted);
          EXPECT_EQ(store_->State(mission).next_sequence, sequence);
          result = testing::Append(*store_, record);
        }
        ASSERT_TRUE(result.ok()) << result.status();
        EXPECT_TRUE(result->added);
        session.acknowledged[mission] = sequence + 1;
        if (!testing::PutBlob(*store_, Blob(mission, sequence)).ok()) {
          ++refused;
          EXPECT_TRUE(testing::PutBlob(*store_, Blob(mission, sequence)).ok());
        }
        session.blobs.insert(Blob(mission, sequence));
      }
      store_.reset();
      disk.Reset();
      Session after;
      store_ = *Open(path, after);
      ASSERT_TRUE(store_->Replay().ok());
      ExpectAll(session, after.transcript);
      EXPECT_THAT(store_->Verify().losses, IsEmpty());
      store_.reset();
      for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) {
        std::filesystem::remove(entry.path());
      }
    }
  }
  EXPECT_GT(refused, 0);
  FaultRow("store", absl::StrCat(faults, " single errors: ENOSPC, EIO"),
           absl::StrCat("batches refused ", refused, ", lost 0, doubled 0"));
}

TEST_F(StoreFaultTest, AFullDiskRefusesAndReadsGoOn) {
  FaultVfs& disk = FaultVfs::Instance();
  Session session;
  const std::string path = folder_.File("map.db");
  store_ = *Open(path, session);
  const MissionId& anna = kMissions[0];
  ASSERT_TRUE(testing::Append(*store_, RecordOf(anna, 0, {Blob(anna, 0), Blob(anna, 1)})).ok());
  ASSERT_TRUE(testing::PutBlob(*store_, Blob(anna, 0)).ok());
  ASSERT_TRUE(testing::PutSnapshot(*store_, "solved").ok());
  disk.FailAfter(0, SQLITE_FULL, /*times=*/1'000'000);
  for (int i = 0; i < 50; ++i) {
    EXPECT_EQ(testing::Append(*store_, RecordOf(anna, 1)).status().code(),
              absl::StatusCode::kResourceExhausted);
    EXPECT_EQ(testing::PutBlob(*store_, Blob(anna, 1)).code(),
              absl::StatusCode::kResourceExhausted);
  }
  EXPECT_EQ(store_->DeleteMission(anna).code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(**store_->GetBlob(Sha256(Blob(anna, 0))), Blob(anna, 0));
  EXPECT_EQ(*store_->GetSnapshot(), "solved");
  EXPECT_EQ(store_->State(anna).next_sequence, 1);
  EXPECT_EQ(store_->MissingBlobs(anna, 9).size(), 1u);
  EXPECT_EQ(store_->Verify().submaps, 1);

  disk.Reset();
  for (int i = 1; i < 200; ++i) {
    ASSERT_TRUE(testing::Append(*store_, RecordOf(anna, i)).ok());
  }
  EXPECT_TRUE(testing::PutBlob(*store_, Blob(anna, 1)).ok());
  EXPECT_LT(std::filesystem::file_size(path + "-wal"), 500'000u);
  EXPECT_THAT(store_->Verify().losses, IsEmpty());
}

}  // namespace
}  // namespace overtone
