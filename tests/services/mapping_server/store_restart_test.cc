// SPDX-License-Identifier: Apache-2.0
// What was acknowledged is there again in another process, in the same order, once.
#include <unistd.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/core/storage/sqlite_database.h"
#include "overtone/services/mapping_server/submap_store/store_format.h"
#include "overtone/services/mapping_server/submap_store/store_mark.h"
#include "overtone/services/mapping_server/submap_store/store_verify.h"
#include "overtone/tests/services/mapping_server/store_fixture.h"

namespace overtone {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::MakeClosure;
using testing::RecordOf;

const MissionId kAnna = {"anna", "run"};
const MissionId kBert = {"bert", "run"};

class StoreRestartTest : public ::testing::Test {
 protected:
  absl::Status TryToOpen(const StoreOptions& options = {}) {
    auto store = SqliteSubmapStore::Open(path_, ServerLimits(), told_.Sink(&store_), options);
    if (!store.ok()) return store.status();
    store_ = *std::move(store);
    return store_->Replay();
  }
  void Open(const StoreOptions& options = {}) {
    const absl::Status status = TryToOpen(options);
    ASSERT_TRUE(status.ok()) << status;
  }
  void Restart() {
    store_.reset();
    told_.Clear();
    Open();
  }
  void Append(const MissionId& mission, int64_t sequence,
              const std::vector<std::string>& blobs = {}) {
    const auto result = testing::Append(*store_, RecordOf(mission, sequence, blobs));
    ASSERT_TRUE(result.ok()) << result.status();
  }

  TemporaryDirectory folder_;
  std::string path_ = folder_.File("map.db");
  testing::ToldList told_;
  std::unique_ptr<SqliteSubmapStore> store_;
};

TEST_F(StoreRestartTest, TheLogComesBackInItsOrderThenTheClouds) {
  Open();
  Append(kBert, 0, {"two", "never came", "given up"});
  Append(kAnna, 0, {"one", "two"});
  ASSERT_TRUE(testing::AppendFinding(*store_, {"accepted", {kAnna}}).ok());
  ASSERT_TRUE(
      testing::AppendClosures(*store_, {RecordOf(MakeClosure({kAnna, 0}, {kBert, 4}))}).ok());
  Append(kAnna, 1);
  ASSERT_TRUE(testing::PutBlob(*store_, "two").ok());
  ASSERT_TRUE(testing::PutBlob(*store_, "one").ok());
  store_->AbandonBlob(kBert, Sha256("given up"));
  ASSERT_TRUE(testing::PutSnapshot(*store_, "solved").ok());
  const auto missions = store_->Missions();
  Restart();
  EXPECT_THAT(told_.all(),
              ElementsAre("bert/run:0 submap", "anna/run:0 submap", "finding accepted",
                          "closure anna/run:0-bert/run:4", "anna/run:5 submap", "anna/run:0 one",
                          "anna/run:1 two", "bert/run:0 two", "bert/run:2 gone"));
  EXPECT_EQ(*store_->GetSnapshot(), "solved");
  ASSERT_EQ(store_->Missions().size(), 2u);
  for (const auto& [mission, state] : missions) {
    EXPECT_EQ(store_->State(mission).next_sequence, state.next_sequence);
    EXPECT_EQ(store_->State(mission).next_index, state.next_index);
    EXPECT_EQ(store_->State(mission).last_stamp, state.last_stamp);
    EXPECT_EQ(store_->State(mission).stored_at, state.stored_at);
    EXPECT_EQ(store_->State(mission).missing_blobs, state.missing_blobs);
  }
  EXPECT_EQ(store_->Clouds().stored, 3);
  EXPECT_EQ(store_->Clouds().missing, 1);
  EXPECT_THAT(store_->Verify().losses, IsEmpty());
}

TEST_F(StoreRestartTest, WhatWasSentBeforeIsKnownAfterwards) {
  Open();
  Append(kAnna, 0);
  const LoopClosureRecord closure = RecordOf(MakeClosure({kAnna, 0}, {kAnna, 4}));
  ASSERT_EQ(*testing::AppendClosures(*store_, {closure}), 1);
  Restart();
  EXPECT_FALSE(testing::Append(*store_, RecordOf(kAnna, 0))->added);
  EXPECT_EQ(testing::Append(*store_, RecordOf(kAnna, testing::MakeSubmap(0, 0, 4))).status().code(),
            absl::StatusCode::kAlreadyExists);
  EXPECT_EQ(*testing::AppendClosures(*store_, {closure}), 0);
  EXPECT_TRUE(testing::Append(*store_, RecordOf(kAnna, 1))->added);
}

TEST_F(StoreRestartTest, AppendsWaitForTheReplay) {
  Open();
  Append(kAnna, 0);
  store_.reset();
  store_ = *SqliteSubmapStore::Open(path_, ServerLimits(), told_.Sink(&store_));
  absl::StatusOr<AppendResult> result = absl::UnknownError("not done");
  absl::Notification done;
  store_->Append(RecordOf(kAnna, 1), [&](const absl::StatusOr<AppendResult>& r) {
    result = r;
    done.Notify();
  });
  EXPECT_FALSE(done.HasBeenNotified());
  ASSERT_TRUE(store_->Replay().ok());
  done.WaitForNotification();
  EXPECT_TRUE(result.ok()) << result.status();
  EXPECT_EQ(store_->State(kAnna).next_sequence, 2);
}

TEST_F(StoreRestartTest, AStoreThatNeverReplaysAnswersAtItsEnd) {
  Open();
  Append(kAnna, 0);
  store_.reset();
  store_ = *SqliteSubmapStore::Open(path_, ServerLimits(), told_.Sink(&store_));
  absl::Status status;
  store_->Append(RecordOf(kAnna, 1),
                 [&](const absl::StatusOr<AppendResult>& result) { status = result.status(); });
  store_.reset();
  EXPECT_EQ(status.code(), absl::StatusCode::kUnavailable);
}

TEST_F(StoreRestartTest, ADeletedMissionGivesItsSpaceBackAndStaysDeleted) {
  Open();
  std::vector<std::string> blobs;
  for (int i = 0; i < 5; ++i) blobs.push_back(testing::EncodedCloud(i, 50'000));
  Append(kAnna, 0, blobs);
  Append(kBert, 0);
  for (const std::string& blob : blobs) ASSERT_TRUE(testing::PutBlob(*store_, blob).ok());
  ASSERT_TRUE(store_->DeleteMission(kBert).ok());  // and what is in the log goes into the file
  const auto before = std::filesystem::file_size(path_);
  ASSERT_TRUE(store_->DeleteMission(kAnna).ok());
  const auto after = std::filesystem::file_size(path_);
  EXPECT_GT(before, 5 * blobs[0].size());
  EXPECT_LT(after, 100'000u);
  EXPECT_EQ(std::filesystem::file_size(path_ + "-wal"), 0u);
  Restart();
  EXPECT_THAT(told_.all(), IsEmpty());
  EXPECT_THAT(store_->Missions(), IsEmpty());
  EXPECT_THAT(store_->Verify().losses, IsEmpty());
}

TEST_F(StoreRestartTest, TheLogOfTheFileStaysBounded) {
  StoreOptions options;
  options.checkpoint_pages_when_idle = 50;
  options.checkpoint_pages = 100;
  Open(options);
  for (int i = 0; i < 60; ++i) {
    ASSERT_TRUE(testing::PutSnapshot(*store_, std::string(100'000, static_cast<char>(i))).ok());
  }
  // Of one snapshot and what a checkpoint waits for.
  EXPECT_LT(std::filesystem::file_size(path_ + "-wal"), 1'000'000u);
}

TEST_F(StoreRestartTest, AFileOfANewerVersionIsRefusedAndLeftAlone) {
  Open();
  Append(kAnna, 0);
  store_.reset();
  {
    auto database = *SqliteDatabase::Open(path_, SqliteDatabase::Mode::kReadWrite);
    const int version = kStoreFormatVersion + 1;
    auto put = *database->Prepare("UPDATE format SET version = ?, checksum = ?");
    const std::string checksum = FormatChecksum(version);
    ASSERT_TRUE(put.BindInt(1, version).BindBlob(2, checksum).Run().ok());
    ASSERT_TRUE(database->Execute("PRAGMA user_version=" + std::to_string(version)).ok());
  }
  const absl::Status status = TryToOpen();
  EXPECT_EQ(status.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(status.message()), HasSubstr("start a newer one"));
  EXPECT_EQ(VerifyStoreFile(path_).status().code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_TRUE(std::filesystem::exists(path_));
}

// Files as each version wrote them. A release adds one: see the README there.
TEST_F(StoreRestartTest, FilesOfEveryVersionAreRead) {
  const std::filesystem::path folder = std::string(OVERTONE_SOURCE_DIR) + "/tests/data/store";
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".db") continue;
    SCOPED_TRACE(entry.path());
    ++files;
    std::filesystem::copy_file(entry.path(), path_,
                               std::filesystem::copy_options::overwrite_existing);
    const absl::StatusOr<StoreReport> report = VerifyStoreFile(path_);
    ASSERT_TRUE(report.ok()) << report.status();
    EXPECT_THAT(report->losses, IsEmpty());
    told_.Clear();
    Open();
    EXPECT_THAT(told_.all(),
                ElementsAre("anna/run:0 submap", "bert/run:0 submap", "finding accepted",
                            "closure anna/run:0-bert/run:4", "anna/run:5 submap", "anna/run:0 one",
                            "anna/run:1 gone", "bert/run:0 one"));
    EXPECT_EQ(*store_->GetSnapshot(), "solved");
    Append(kAnna, 2);
    store_.reset();
    for (const char* suffix : {"", "-wal", "-shm", "-mark"}) {
      std::filesystem::remove(path_ + suffix);
    }
  }
  EXPECT_GE(files, kStoreFormatVersion);
}

// Makes such a file where STORE_SAMPLE says; skipped otherwise.
TEST_F(StoreRestartTest, WriteASampleFile) {
  const char* sample = std::getenv("STORE_SAMPLE");
  if (sample == nullptr) GTEST_SKIP() << "STORE_SAMPLE is not set";
  Open();
  Append(kAnna, 0, {"one", "two"});
  Append(kBert, 0, {"one"});
  ASSERT_TRUE(testing::AppendFinding(*store_, {"accepted", {kAnna}}).ok());
  ASSERT_TRUE(
      testing::AppendClosures(*store_, {RecordOf(MakeClosure({kAnna, 0}, {kBert, 4}))}).ok());
  Append(kAnna, 1);
  ASSERT_TRUE(testing::PutBlob(*store_, "one").ok());
  store_->AbandonBlob(kAnna, Sha256("two"));
  ASSERT_TRUE(testing::PutSnapshot(*store_, "solved").ok());
  ASSERT_TRUE(store_->Backup(sample).ok());
}

// A second process of this test: it writes submaps until the failpoint kills it.
TEST_F(StoreRestartTest, AFailpointKillsAtTheGivenPass) {
  if (const char* path = std::getenv("STORE_TO_WRITE")) {
    path_ = path;
    Open();
    for (int i = 0; i < 10; ++i) Append(kAnna, i);
    return;
  }
  struct Case {
    const char* failpoint;
    int64_t stored;  // the first append is durable, the second one is or is not
  };
  for (const Case& c : {Case{"store_before_write", 1},
                        {"store_after_write", 1},
                        {"store_before_commit", 1},
                        {"store_after_commit", 2},
                        {"store_before_ack", 2}}) {
    SCOPED_TRACE(c.failpoint);
    path_ = folder_.File(std::string(c.failpoint) + ".db");
    const std::string command =
        "OVERTONE_FAILPOINT=" + std::string(c.failpoint) + ":2 STORE_TO_WRITE='" + path_ + "' '" +
        std::filesystem::read_symlink("/proc/self/exe").string() +
        "' --gtest_filter=StoreRestartTest.AFailpointKillsAtTheGivenPass > /dev/null 2>&1";
    ASSERT_EQ(WEXITSTATUS(std::system(command.c_str())), 128 + SIGKILL);
    Open();
    EXPECT_EQ(store_->State(kAnna).next_sequence, c.stored);
    EXPECT_THAT(store_->Verify().losses, IsEmpty());
    store_.reset();
  }
}

}  // namespace
}  // namespace overtone
