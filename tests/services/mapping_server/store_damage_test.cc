// SPDX-License-Identifier: Apache-2.0
// What is damaged is named, set aside, and never told as if it were whole; the rest is served.
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/core/storage/sqlite_database.h"
#include "overtone/services/mapping_server/submap_store/store_verify.h"
#include "overtone/tests/services/mapping_server/store_fixture.h"

namespace overtone {
namespace {

using ::testing::AnyOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::MakeClosure;
using ::testing::Not;
using testing::RecordOf;

const MissionId kAnna = {"anna", "run"};
const MissionId kBert = {"bert", "run"};

class StoreDamageTest : public ::testing::Test {
 protected:
  // Log entries 1 to 6: anna's submaps 0 to 2, bert's 0, a closure, a finding.
  StoreDamageTest() {
    Open();
    Append(kAnna, 0, {"one"});
    Append(kAnna, 1, {"two"});
    Append(kAnna, 2);
    Append(kBert, 0, {"one"});
    EXPECT_TRUE(
        testing::AppendClosures(*store_, {RecordOf(MakeClosure({kAnna, 0}, {kBert, 4}))}).ok());
    EXPECT_TRUE(testing::AppendFinding(*store_, {"accepted", {kAnna}}).ok());
    EXPECT_TRUE(testing::PutBlob(*store_, "one").ok());
    EXPECT_TRUE(testing::PutBlob(*store_, "two").ok());
    EXPECT_TRUE(testing::PutSnapshot(*store_, "solved").ok());
  }

  void Open() {
    told_.Clear();
    auto store = SqliteSubmapStore::Open(path_, ServerLimits(), told_.Sink(&store_));
    ASSERT_TRUE(store.ok()) << store.status();
    store_ = *std::move(store);
    const absl::Status status = store_->Replay();
    ASSERT_TRUE(status.ok()) << status;
  }
  void Append(const MissionId& mission, int64_t sequence,
              const std::vector<std::string>& blobs = {}) {
    EXPECT_TRUE(testing::Append(*store_, RecordOf(mission, sequence, blobs)).ok());
  }
  void Execute(const std::string& sql) {
    store_.reset();
    auto database = *SqliteDatabase::Open(path_, SqliteDatabase::Mode::kReadWrite);
    const absl::Status status = database->Execute(sql);
    ASSERT_TRUE(status.ok()) << status;
  }
  // Closed, so that all is in the one file.
  void Overwrite(const std::function<void(std::string& bytes)>& change) {
    store_.reset();
    std::string bytes;
    {
      std::ifstream file(path_, std::ios::binary);
      bytes.assign(std::istreambuf_iterator<char>(file), {});
    }
    change(bytes);
    std::ofstream(path_, std::ios::binary | std::ios::trunc) << bytes;
  }
  std::vector<std::string> Losses() const { return store_->Verify().losses; }

  TemporaryDirectory folder_;
  std::string path_ = folder_.File("map.db");
  testing::ToldList told_;
  std::unique_ptr<SqliteSubmapStore> store_;
};

TEST_F(StoreDamageTest, AMissionKeepsWhatComesBeforeALostSubmap) {
  Execute("UPDATE log SET bytes = zeroblob(length(bytes)) WHERE position = 2");
  Open();
  EXPECT_THAT(told_.all(),
              ElementsAre("anna/run:0 submap", "bert/run:0 submap", "closure anna/run:0-bert/run:4",
                          "finding accepted", "anna/run:0 one", "bert/run:0 one"));
  EXPECT_THAT(Losses(), Contains(HasSubstr("log entry 2, submap 1 of anna/run: damaged")));
  EXPECT_THAT(Losses(), Contains(HasSubstr("log entry 3, submap 2 of anna/run: cannot be used")));
  EXPECT_EQ(store_->State(kAnna).next_sequence, 1);
  EXPECT_EQ(testing::Append(*store_, RecordOf(kAnna, 3)).status().code(),
            absl::StatusCode::kDataLoss);
  EXPECT_EQ(testing::Append(*store_, RecordOf(kAnna, 1)).status().code(),
            absl::StatusCode::kDataLoss);
  Append(kBert, 1);
  // It is known from then on, and deleting the mission ends it.
  store_.reset();
  Open();
  EXPECT_THAT(Losses(), Contains(HasSubstr("submap 1 of anna/run: damaged")));
  EXPECT_EQ(testing::Append(*store_, RecordOf(kAnna, 3)).status().code(),
            absl::StatusCode::kDataLoss);
  EXPECT_TRUE(store_->DeleteMission(kAnna).ok());
  Append(kAnna, 0);
}

TEST_F(StoreDamageTest, ALostLastSubmapIsMissed) {
  Execute("DELETE FROM log WHERE position = 3");
  Open();
  EXPECT_THAT(Losses(), Contains(HasSubstr("log entry 3: vanished")));
  EXPECT_THAT(Losses(), Contains(HasSubstr("mission anna/run: its submaps from 2 on are lost")));
  EXPECT_EQ(testing::Append(*store_, RecordOf(kAnna, 2)).status().code(),
            absl::StatusCode::kDataLoss);
}

TEST_F(StoreDamageTest, TheEndOfTheLogIsMissed) {
  Execute("DELETE FROM log WHERE position >= 5");
  Open();
  EXPECT_THAT(Losses(), Contains(HasSubstr("log entries 5 to 6: vanished")));
}

// What a row says of itself is believed as little as its bytes.
TEST_F(StoreDamageTest, ARowUnderAnotherNameIsNotTold) {
  Execute("UPDATE log SET about = 'carl/run' WHERE position = 4");
  Open();
  EXPECT_THAT(told_.all(), Not(Contains(HasSubstr("carl"))));
  EXPECT_THAT(Losses(), Contains("log entry 4: damaged"));
  EXPECT_THAT(Losses(), Contains(HasSubstr("mission bert/run: its submaps from 0 on are lost")));
}

TEST_F(StoreDamageTest, ADamagedCloudIsWantedAgain) {
  Execute("UPDATE blobs SET bytes = 'eno' WHERE id = 1");
  Open();
  EXPECT_THAT(told_.all(), Contains("anna/run:0 unreadable"));
  testing::WaitUntilIdle(*store_);
  EXPECT_THAT(Losses(), ElementsAre(HasSubstr("damaged; it is asked for again")));
  EXPECT_EQ(store_->MissingBlobs(kAnna, 9).size(), 1u);
  EXPECT_EQ(store_->MissingBlobs(kBert, 9).size(), 1u);
  EXPECT_EQ(store_->Clouds().stored, 1);
  told_.Clear();
  EXPECT_TRUE(testing::PutBlob(*store_, "one").ok());
  EXPECT_THAT(told_.all(), ElementsAre("anna/run:0 one", "bert/run:0 one"));
  EXPECT_EQ(store_->Clouds().missing, 0);
}

TEST_F(StoreDamageTest, ADamagedCloudThatItsRobotGaveUpIsGone) {
  Append(kBert, 1, {"rare"});
  store_->AbandonBlob(kBert, Sha256("rare"));
  EXPECT_TRUE(testing::PutBlob(*store_, "rare").ok());
  Execute("UPDATE blobs SET bytes = 'x' WHERE id = 3");
  Open();
  testing::WaitUntilIdle(*store_);
  EXPECT_THAT(told_.all(), Contains("bert/run:5 gone"));
  EXPECT_EQ(store_->MissingBlobs(kBert, 9).size(), 0u);
}

TEST_F(StoreDamageTest, ADamagedSnapshotIsNone) {
  Execute("UPDATE snapshot SET bytes = 'wrong'");
  Open();
  EXPECT_EQ(store_->GetSnapshot().status().code(), absl::StatusCode::kNotFound);
  EXPECT_THAT(Losses(), Contains(HasSubstr("snapshot")));
  EXPECT_EQ(told_.all().size(), 9u);
}

TEST_F(StoreDamageTest, CountersThatAreDamagedAreMadeAnew) {
  Execute(
      "UPDATE state SET log_end = 1; UPDATE missions SET next_sequence = 7;"
      "INSERT INTO abandoned VALUES(9, 'anna/run', 'x', 'y')");
  Open();
  EXPECT_THAT(Losses(), Contains(HasSubstr("the count of log entries is damaged")));
  EXPECT_THAT(Losses(), Contains(HasSubstr("mission entry 1: damaged")));
  EXPECT_THAT(Losses(), Contains(HasSubstr("abandoned cloud 9: damaged")));
  Append(kAnna, 3);
  store_.reset();
  Open();
  EXPECT_EQ(store_->State(kAnna).next_sequence, 4);
}

// The first page has SQLite's header, the tables' names and roots.
TEST_F(StoreDamageTest, WithoutItsFirstPageAFileIsStillSalvaged) {
  const std::vector<std::string> told = [this] {
    store_.reset();
    Open();
    return told_.all();
  }();
  Overwrite([](std::string& bytes) { std::fill_n(bytes.begin(), 4096, '\0'); });
  Open();
  EXPECT_EQ(told_.all(), told);
  EXPECT_EQ(*store_->GetSnapshot(), "solved");
  EXPECT_THAT(Losses(), Contains(HasSubstr("it is kept as")));
  int kept = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) {
    kept += entry.path().string().find("map.db.damaged-") != std::string::npos;
  }
  EXPECT_EQ(kept, 1);
  Append(kAnna, 3);
}

TEST_F(StoreDamageTest, AFileThatIsNoDatabaseIsSetAside) {
  Overwrite([](std::string& bytes) { bytes = "These are not the submaps you are looking for."; });
  Open();
  EXPECT_THAT(told_.all(), IsEmpty());
  EXPECT_THAT(Losses(), Contains(HasSubstr("log entries 1 to 6: vanished")));
  Append(kAnna, 0);
}

TEST_F(StoreDamageTest, AnEmptyFileAndAMissingOneAreMissed) {
  Overwrite([](std::string& bytes) { bytes.clear(); });
  Open();
  EXPECT_THAT(Losses(), Contains(HasSubstr("log entries 1 to 6: vanished")));
  store_.reset();
  std::filesystem::remove(path_);
  Open();
  EXPECT_THAT(Losses(), Contains(HasSubstr("log entries 1 to 6: vanished")));
}

// SQLite drops the end of a damaged write-ahead log without a word.
TEST_F(StoreDamageTest, ALogThatLostItsEndIsMissed) {
  const std::string copy = folder_.File("copy.db");
  std::filesystem::copy_file(path_, copy);
  std::filesystem::copy_file(path_ + "-mark", copy + "-mark");
  // As after a kill, with the log cut in half.
  std::filesystem::copy_file(path_ + "-wal", copy + "-wal");
  std::filesystem::resize_file(copy + "-wal", std::filesystem::file_size(copy + "-wal") / 2);
  path_ = copy;
  store_.reset();
  Open();
  EXPECT_THAT(Losses(), Contains(HasSubstr("commits are lost, with log entries after")));
  store_.reset();
  Open();
  EXPECT_THAT(Losses(), Contains(HasSubstr("commits are lost, with log entries after")));
}

// Pages behind a running store's back: found by the next read or write, salvaged, and served on.
TEST_F(StoreDamageTest, AStructureDamagedWhileServingIsSalvaged) {
  ASSERT_TRUE(store_->DeleteMission(kBert).ok());  // all is in the file, none of it in the log
  {
    std::fstream file(path_, std::ios::binary | std::ios::in | std::ios::out);
    const std::string garbage(4096, '\x05');
    for (int64_t page = 2; page < 12; ++page) {
      file.seekp(page * 4096);
      file.write(garbage.data(), 4096);
    }
  }
  // Not everything is read from memory for ever: 500 pages are more than SQLite keeps.
  std::string big(4'000'000, 'x');
  EXPECT_TRUE(testing::PutSnapshot(*store_, big).ok());
  const auto result = testing::Append(*store_, RecordOf(kBert, 0));
  EXPECT_TRUE(result.ok()) << result.status();
  store_.reset();
  Open();
  EXPECT_THAT(told_.all(), Contains("bert/run:0 submap"));
  EXPECT_THAT(Losses(), Not(IsEmpty()));
}

TEST_F(StoreDamageTest, VerifyFindsWithoutRepairing) {
  Execute("UPDATE log SET bytes = x'00' WHERE position = 6; UPDATE blobs SET bytes = x'00'");
  const absl::StatusOr<StoreReport> report = VerifyStoreFile(path_);
  ASSERT_TRUE(report.ok()) << report.status();
  EXPECT_EQ(report->submaps, 4);
  EXPECT_EQ(report->findings, 0);
  EXPECT_EQ(report->losses.size(), 3u);
  EXPECT_EQ(VerifyStoreFile(path_)->losses.size(), 3u);
}

TEST_F(StoreDamageTest, AFileOfSomebodyElseIsNoStore) {
  const std::string other = folder_.File("other.db");
  {
    auto database = *SqliteDatabase::Open(other, SqliteDatabase::Mode::kCreate);
    ASSERT_TRUE(database->Execute("CREATE TABLE t(x); INSERT INTO t VALUES(1)").ok());
  }
  EXPECT_EQ(VerifyStoreFile(other).status().code(), absl::StatusCode::kDataLoss);
  EXPECT_EQ(VerifyStoreFile(folder_.File("none")).status().code(), absl::StatusCode::kNotFound);
  // A schema can hold code: nothing but ours is accepted.
  Execute("CREATE TRIGGER t AFTER INSERT ON log BEGIN DELETE FROM log; END");
  EXPECT_EQ(VerifyStoreFile(path_).status().code(), absl::StatusCode::kDataLoss);
}

}  // namespace
}  // namespace overtone
