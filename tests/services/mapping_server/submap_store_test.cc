// SPDX-License-Identifier: Apache-2.0
// What every store promises, whether it lasts as long as the process or longer.
#include "overtone/services/mapping_server/submap_store.h"

#include <memory>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/services/mapping_server/submap_store/store_verify.h"
#include "overtone/tests/services/mapping_server/store_fixture.h"

namespace overtone {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using testing::MakeClosure;
using testing::RecordOf;

const MissionId kAnna = {"anna", "run"};
const MissionId kBert = {"bert", "run"};

class SubmapStoreTest : public ::testing::TestWithParam<bool> {
 protected:
  void Open(const ServerLimits& limits = ServerLimits()) {
    auto store = SqliteSubmapStore::Open(GetParam() ? folder_.File("map.db") : ":memory:", limits,
                                         told_.Sink(&store_));
    ASSERT_TRUE(store.ok()) << store.status();
    store_ = *std::move(store);
    ASSERT_TRUE(store_->Replay().ok());
  }

  void Append(const MissionId& mission, int64_t sequence, const std::vector<std::string>& blobs) {
    const auto result = testing::Append(*store_, RecordOf(mission, sequence, blobs));
    EXPECT_TRUE(result.ok()) << result.status();
  }

  absl::Status AppendStatus(SubmapRecord record) {
    return testing::Append(*store_, std::move(record)).status();
  }

  absl::Status Put(const std::string& blob) { return testing::PutBlob(*store_, blob); }

  std::vector<std::string> Missing(const MissionId& mission) {
    std::vector<std::string> digests;
    for (const MissingBlob& blob : store_->MissingBlobs(mission, 256)) {
      digests.push_back(blob.sha256);
    }
    return digests;
  }

  TemporaryDirectory folder_;
  testing::ToldList told_;
  std::unique_ptr<SqliteSubmapStore> store_;
};

INSTANTIATE_TEST_SUITE_P(Kinds, SubmapStoreTest, ::testing::Bool(),
                         [](const auto& info) { return info.param ? "OnDisk" : "InMemory"; });

TEST_P(SubmapStoreTest, TellsOfEachCloudOnceWhenSubmapAndBlobAreThere) {
  Open();
  Append(kAnna, 0, {"one", "two"});
  EXPECT_THAT(told_.all(), ElementsAre("anna/run:0 submap"));
  EXPECT_TRUE(Put("two").ok());
  EXPECT_TRUE(Put("two").ok());
  Append(kBert, 0, {"two", "one", "two"});
  EXPECT_TRUE(Put("one").ok());
  Append(kAnna, 0, {"one", "two"});  // again
  EXPECT_THAT(told_.all(),
              ElementsAre("anna/run:0 submap", "anna/run:1 two", "bert/run:0 submap",
                          "bert/run:0 two", "bert/run:2 two", "anna/run:0 one", "bert/run:1 one"));
  EXPECT_EQ(store_->Clouds().stored, 5);
  EXPECT_EQ(store_->Clouds().missing, 0);
}

TEST_P(SubmapStoreTest, MissingBlobsComeByKeyframeEachOnce) {
  Open();
  Append(kAnna, 0, {"c", "a", "c", "b"});
  EXPECT_THAT(Missing(kAnna), ElementsAre(Sha256("c"), Sha256("a"), Sha256("b")));
  EXPECT_EQ(store_->MissingBlobs(kAnna, 2).size(), 2u);
  EXPECT_EQ(store_->State(kAnna).missing_blobs, 4);
  EXPECT_TRUE(Put("c").ok());
  EXPECT_THAT(Missing(kAnna), ElementsAre(Sha256("a"), Sha256("b")));
  EXPECT_EQ(store_->State(kAnna).missing_blobs, 2);
  EXPECT_EQ(store_->Missions().at(kAnna).missing_blobs, 2);
  EXPECT_THAT(Missing(kBert), IsEmpty());
}

TEST_P(SubmapStoreTest, AnAbandonedBlobIsNotMissingButStillTaken) {
  Open();
  Append(kAnna, 0, {"one"});
  Append(kBert, 0, {"one"});
  store_->AbandonBlob(kAnna, Sha256("one"));
  EXPECT_THAT(Missing(kAnna), IsEmpty());     // at once
  store_->AbandonBlob(kAnna, Sha256("one"));  // again
  store_->AbandonBlob(kAnna, Sha256("never heard of"));
  EXPECT_THAT(Missing(kBert), ElementsAre(Sha256("one")));
  EXPECT_EQ(store_->Clouds().missing, 1);
  testing::WaitUntilIdle(*store_);
  EXPECT_TRUE(Put("one").ok());
  store_->AbandonBlob(kAnna, Sha256("one"));  // too late
  testing::WaitUntilIdle(*store_);
  EXPECT_THAT(told_.all(), ElementsAre("anna/run:0 submap", "bert/run:0 submap", "anna/run:0 gone",
                                       "anna/run:0 one", "bert/run:0 one"));
  EXPECT_EQ(store_->Clouds().missing, 0);
}

TEST_P(SubmapStoreTest, ABlobThatNoCloudWaitsForIsNotKept) {
  Open();
  EXPECT_EQ(Put("one").code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(store_->GetBlob(Sha256("one")).status().code(), absl::StatusCode::kNotFound);
}

TEST_P(SubmapStoreTest, TakesASubmapOnceAndInOrder) {
  Open();
  const auto first = testing::Append(*store_, RecordOf(kAnna, 0));
  ASSERT_TRUE(first.ok());
  EXPECT_TRUE(first->added);
  EXPECT_EQ(first->state.next_sequence, 1);
  EXPECT_EQ(first->state.next_index, 5);
  EXPECT_EQ(AppendStatus(RecordOf(kAnna, 2)).code(), absl::StatusCode::kOutOfRange);
  EXPECT_EQ(AppendStatus(RecordOf(kAnna, testing::MakeSubmap(1, 6, 5))).code(),
            absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(AppendStatus(RecordOf(kAnna, testing::MakeSubmap(0, 0, 4))).code(),
            absl::StatusCode::kAlreadyExists);
  const auto again = testing::Append(*store_, RecordOf(kAnna, 0));
  ASSERT_TRUE(again.ok());
  EXPECT_FALSE(again->added);
  EXPECT_THAT(told_.all(), ElementsAre("anna/run:0 submap"));
}

// What waits together is stored together, each by the rules that those before it make.
TEST_P(SubmapStoreTest, AppendsThatDoNotWaitForEachOtherFollowTheSameRules) {
  Open();
  std::vector<absl::StatusCode> codes(6, absl::StatusCode::kUnknown);
  const std::vector<SubmapRecord> records = {
      RecordOf(kAnna, 0),
      RecordOf(kAnna, 1),
      RecordOf(kAnna, 3),                             // a gap
      RecordOf(kAnna, 1),                             // again
      RecordOf(kAnna, testing::MakeSubmap(1, 5, 4)),  // other content
      RecordOf(kAnna, 2)};
  for (size_t i = 0; i < records.size(); ++i) {
    store_->Append(records[i], [&codes, i](const absl::StatusOr<AppendResult>& result) {
      codes[i] = result.status().code();
    });
  }
  store_.reset();  // finishes what waits
  EXPECT_THAT(codes, ElementsAre(absl::StatusCode::kOk, absl::StatusCode::kOk,
                                 absl::StatusCode::kOutOfRange, absl::StatusCode::kOk,
                                 absl::StatusCode::kAlreadyExists, absl::StatusCode::kOk));
  EXPECT_EQ(told_.all().size(), 3u);
}

TEST_P(SubmapStoreTest, LimitsAreOnWhatIsStored) {
  ServerLimits limits;
  limits.max_missions_per_map = 1;
  limits.max_keyframes_per_mission = 9;
  limits.max_loop_closures_per_map = 1;
  limits.max_stored_blob_bytes = 4;
  Open(limits);
  Append(kAnna, 0, {"1234", "5"});
  EXPECT_EQ(AppendStatus(RecordOf(kBert, 0)).code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(AppendStatus(RecordOf(kAnna, 1)).code(), absl::StatusCode::kResourceExhausted);
  EXPECT_TRUE(Put("1234").ok());
  EXPECT_EQ(Put("5").code(), absl::StatusCode::kResourceExhausted);
  const LoopClosureRecord one = RecordOf(MakeClosure({kAnna, 0}, {kAnna, 4}));
  const LoopClosureRecord two = RecordOf(MakeClosure({kAnna, 1}, {kAnna, 4}));
  EXPECT_EQ(testing::AppendClosures(*store_, {one, two}).status().code(),
            absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(*testing::AppendClosures(*store_, {one}), 1);
}

TEST_P(SubmapStoreTest, ALoopClosureIsNewOnce) {
  Open();
  const LoopClosureRecord one = RecordOf(MakeClosure({kAnna, 0}, {kAnna, 4}));
  const LoopClosureRecord two = RecordOf(MakeClosure({kAnna, 1}, {kBert, 4}));
  EXPECT_EQ(*testing::AppendClosures(*store_, {one, one}), 1);
  EXPECT_EQ(*testing::AppendClosures(*store_, {one, two}), 1);
  EXPECT_TRUE(testing::AppendFinding(*store_, {"seen", {kAnna}}).ok());
  EXPECT_THAT(told_.all(), ElementsAre("closure anna/run:0-anna/run:4",
                                       "closure anna/run:1-bert/run:4", "finding seen"));
}

TEST_P(SubmapStoreTest, TheLastSnapshotCounts) {
  Open();
  EXPECT_EQ(store_->GetSnapshot().status().code(), absl::StatusCode::kNotFound);
  EXPECT_TRUE(testing::PutSnapshot(*store_, "first").ok());
  EXPECT_TRUE(testing::PutSnapshot(*store_, "second").ok());
  EXPECT_EQ(*store_->GetSnapshot(), "second");
}

TEST_P(SubmapStoreTest, ADeletedMissionLeavesWhatOthersUse) {
  Open();
  Append(kAnna, 0, {"hers", "shared"});
  Append(kBert, 0, {"shared", "wanted"});
  for (const char* blob : {"hers", "shared"}) EXPECT_TRUE(Put(blob).ok());
  const LoopClosureRecord between = RecordOf(MakeClosure({kAnna, 0}, {kBert, 4}));
  EXPECT_EQ(*testing::AppendClosures(*store_, {between}), 1);
  EXPECT_TRUE(testing::AppendFinding(*store_, {"about both", {kAnna, kBert}}).ok());
  EXPECT_TRUE(testing::AppendFinding(*store_, {"about bert", {kBert}}).ok());
  EXPECT_TRUE(testing::PutSnapshot(*store_, "of both").ok());

  EXPECT_TRUE(store_->DeleteMission(kAnna).ok());
  EXPECT_EQ(store_->DeleteMission(kAnna).code(), absl::StatusCode::kNotFound);

  EXPECT_EQ(store_->State(kAnna).next_sequence, 0);
  EXPECT_EQ(store_->Missions().size(), 1u);
  EXPECT_EQ(store_->GetBlob(Sha256("hers")).status().code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(**store_->GetBlob(Sha256("shared")), "shared");
  EXPECT_EQ(store_->Clouds().stored, 1);
  EXPECT_EQ(store_->Clouds().missing, 1);
  EXPECT_EQ(store_->GetSnapshot().status().code(), absl::StatusCode::kNotFound);
  const StoreReport report = store_->Verify();
  EXPECT_EQ(report.missions, 1);
  EXPECT_EQ(report.submaps, 1);
  EXPECT_EQ(report.loop_closures, 0);
  EXPECT_EQ(report.findings, 1);
  EXPECT_EQ(report.blobs, 1);
  EXPECT_THAT(report.losses, IsEmpty());
  // Its name is free again.
  Append(kAnna, 0, {"hers"});
  EXPECT_EQ(*testing::AppendClosures(*store_, {between}), 1);
  EXPECT_THAT(Missing(kAnna), ElementsAre(Sha256("hers")));
}

TEST_P(SubmapStoreTest, ABackupIsAStoreOfItsOwn) {
  Open();
  Append(kAnna, 0, {"one"});
  EXPECT_TRUE(Put("one").ok());
  const std::string copy = folder_.File("copy.db");
  ASSERT_TRUE(store_->Backup(copy).ok());
  EXPECT_EQ(store_->Backup(copy).code(), absl::StatusCode::kAlreadyExists);
  Append(kAnna, 1, {});

  const absl::StatusOr<StoreReport> report = VerifyStoreFile(copy);
  ASSERT_TRUE(report.ok()) << report.status();
  EXPECT_EQ(report->submaps, 1);
  EXPECT_EQ(report->blobs, 1);
  EXPECT_GT(report->bytes_on_disk, 0);
  EXPECT_THAT(report->losses, IsEmpty());

  testing::ToldList told;
  std::unique_ptr<SqliteSubmapStore> restored;
  restored = *SqliteSubmapStore::Open(copy, ServerLimits(), told.Sink(&restored));
  ASSERT_TRUE(restored->Replay().ok());
  EXPECT_THAT(told.all(), ElementsAre("anna/run:0 submap", "anna/run:0 one"));
}

TEST_P(SubmapStoreTest, ReadsFromWithinDoneDoNotWait) {
  Open();
  absl::Notification done;
  store_->Append(RecordOf(kAnna, 0, {"one"}), [&](const absl::StatusOr<AppendResult>& result) {
    EXPECT_TRUE(result.ok());
    EXPECT_EQ(store_->State(kAnna).next_sequence, 1);
    EXPECT_THAT(Missing(kAnna), ElementsAre(Sha256("one")));
    EXPECT_FALSE(store_->GetBlob(Sha256("one")).ok());
    store_->Append(RecordOf(kAnna, 1), [&](const auto&) { done.Notify(); });
  });
  done.WaitForNotification();
}

}  // namespace
}  // namespace overtone
