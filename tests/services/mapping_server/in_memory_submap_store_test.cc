// SPDX-License-Identifier: Apache-2.0
// When a store tells of clouds. Submaps and limits are tested through the upload stream.
#include "overtone/services/mapping_server/in_memory_submap_store.h"

#include <memory>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/tests/services/mapping_server/cloud_fixture.h"

namespace overtone {
namespace {

using ::testing::ElementsAre;
using testing::MakeSubmapWithClouds;

const MissionId kAnna = {"anna", "run"};
const MissionId kBert = {"bert", "run"};

class InMemorySubmapStoreTest : public ::testing::Test {
 protected:
  InMemorySubmapStoreTest() {
    SubmapStore::Sink sink;
    sink.on_submap = [this](const MissionId& mission, std::shared_ptr<const Submap> submap) {
      told_.push_back(ToString(NodeId{mission, submap->first_index}) + " submap");
    };
    sink.on_loop_closure = [](const LoopClosure&) {};
    sink.on_cloud = [this](const MissionId& mission, int64_t index, const std::string& sha256) {
      told_.push_back(ToString(NodeId{mission, index}) + " " + **store_->GetBlob(sha256));
    };
    sink.on_cloud_gone = [this](const MissionId& mission, int64_t index) {
      told_.push_back(ToString(NodeId{mission, index}) + " gone");
    };
    store_ = std::make_unique<InMemorySubmapStore>(ServerLimits(), sink);
  }

  void Append(const MissionId& mission, int64_t sequence, const std::vector<std::string>& blobs) {
    auto submap =
        std::make_shared<const Submap>(MakeSubmapWithClouds(sequence, 5 * sequence, 5, blobs));
    store_->Append({mission, submap, "bytes", "digest"},
                   [](const absl::StatusOr<AppendResult>& result) { EXPECT_TRUE(result.ok()); });
  }

  absl::Status Put(const std::string& blob) {
    absl::Status status = absl::UnknownError("not done");
    store_->PutBlob(Sha256(blob), std::make_shared<const std::string>(blob),
                    [&](const absl::Status& result) { status = result; });
    return status;
  }

  std::vector<std::string> Missing(const MissionId& mission) {
    std::vector<std::string> digests;
    for (const MissingBlob& blob : store_->MissingBlobs(mission, 256)) {
      digests.push_back(blob.sha256);
    }
    return digests;
  }

  std::vector<std::string> told_;
  std::unique_ptr<InMemorySubmapStore> store_;
};

TEST_F(InMemorySubmapStoreTest, TellsOfEachCloudOnceWhenSubmapAndBlobAreThere) {
  Append(kAnna, 0, {"one", "two"});
  EXPECT_THAT(told_, ElementsAre("anna/run:0 submap"));
  EXPECT_TRUE(Put("two").ok());
  EXPECT_TRUE(Put("two").ok());
  Append(kBert, 0, {"two", "one", "two"});
  EXPECT_TRUE(Put("one").ok());
  Append(kAnna, 0, {"one", "two"});  // again
  EXPECT_THAT(told_,
              ElementsAre("anna/run:0 submap", "anna/run:1 two", "bert/run:0 submap",
                          "bert/run:0 two", "bert/run:2 two", "anna/run:0 one", "bert/run:1 one"));
  EXPECT_EQ(store_->Clouds().stored, 5);
  EXPECT_EQ(store_->Clouds().missing, 0);
}

TEST_F(InMemorySubmapStoreTest, MissingBlobsComeByKeyframeEachOnce) {
  Append(kAnna, 0, {"c", "a", "c", "b"});
  EXPECT_THAT(Missing(kAnna), ElementsAre(Sha256("c"), Sha256("a"), Sha256("b")));
  EXPECT_EQ(store_->MissingBlobs(kAnna, 2).size(), 2u);
  EXPECT_EQ(store_->State(kAnna).missing_blobs, 4);
  EXPECT_TRUE(Put("c").ok());
  EXPECT_THAT(Missing(kAnna), ElementsAre(Sha256("a"), Sha256("b")));
  EXPECT_EQ(store_->State(kAnna).missing_blobs, 2);
  EXPECT_EQ(store_->Missions().at(kAnna).missing_blobs, 2);
  EXPECT_THAT(Missing(kBert), ElementsAre());
}

TEST_F(InMemorySubmapStoreTest, AnAbandonedBlobIsNotMissingButStillTaken) {
  Append(kAnna, 0, {"one"});
  Append(kBert, 0, {"one"});
  store_->AbandonBlob(kAnna, Sha256("one"));
  store_->AbandonBlob(kAnna, Sha256("one"));  // again
  store_->AbandonBlob(kAnna, Sha256("never heard of"));
  EXPECT_THAT(Missing(kAnna), ElementsAre());
  EXPECT_THAT(Missing(kBert), ElementsAre(Sha256("one")));
  EXPECT_EQ(store_->Clouds().missing, 1);
  EXPECT_TRUE(Put("one").ok());
  store_->AbandonBlob(kAnna, Sha256("one"));  // too late
  EXPECT_THAT(told_, ElementsAre("anna/run:0 submap", "bert/run:0 submap", "anna/run:0 gone",
                                 "anna/run:0 one", "bert/run:0 one"));
  EXPECT_EQ(store_->Clouds().missing, 0);
}

TEST_F(InMemorySubmapStoreTest, ABlobThatNoCloudWaitsForIsNotKept) {
  EXPECT_EQ(Put("one").code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(store_->GetBlob(Sha256("one")).status().code(), absl::StatusCode::kNotFound);
}

}  // namespace
}  // namespace overtone
