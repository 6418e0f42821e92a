// SPDX-License-Identifier: Apache-2.0
// Deleting a mission or a map while it is being served: what goes, what stays, who notices.
#include <atomic>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/core/storage/sqlite_database.h"
#include "overtone/services/mapping_server/submap_store/store_rows.h"
#include "overtone/tests/services/mapping_server/maintenance_fixture.h"

namespace overtone {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::MakeClosure;
using testing::MakeSubmap;
using testing::Uploader;
using testing::Watcher;

const MissionId kAnna = {"anna", "run1"};
const MissionId kBert = {"bert", "run1"};

class MapDeletionTest : public testing::MaintenanceTest {
 protected:
  int64_t StoreBytes(const std::string& map) const {
    int64_t bytes = 0;
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator(
             std::filesystem::path(StorePath(map)).parent_path(), error)) {
      bytes += static_cast<int64_t>(entry.file_size());
    }
    return bytes;
  }
};

TEST_F(MapDeletionTest, AMissionGoesWithItsSpaceAndTheOthersStay) {
  UploadWithClouds("mine", kAnna, 1);
  UploadWithClouds("mine", kBert, 2);
  Settle("mine");
  const auto bert = Trajectory("mine", kBert);
  const uint64_t epoch = Settle("mine").map_epoch();
  const auto before = static_cast<int64_t>(std::filesystem::file_size(StorePath("mine")));
  const v1::StoreReport both = Verify("mine");

  const v1::DeleteMissionResponse response = DeleteMission("mine", kAnna);
  const auto after = static_cast<int64_t>(std::filesystem::file_size(StorePath("mine")));
  EXPECT_GT(response.map_epoch(), epoch);
  EXPECT_EQ(Settle("mine").map_epoch(), response.map_epoch());
  // Of two missions with 500 kB of clouds each.
  EXPECT_GT(both.bytes_on_disk(), 800'000);
  EXPECT_GT(response.freed_bytes(), 400'000);
  EXPECT_LT(StoreBytes("mine"), 700'000);
  std::printf("map.db: %ld -> %ld bytes, freed %ld\n", before, after, response.freed_bytes());

  const v1::StoreReport report = Verify("mine");
  EXPECT_EQ(report.missions(), 1);
  EXPECT_EQ(report.submaps(), 1);
  EXPECT_EQ(report.blobs(), 5);
  EXPECT_THAT(report.losses(), IsEmpty());
  EXPECT_EQ(Trajectory("mine", kBert).nodes_size(), bert.nodes_size());
  EXPECT_EQ(UploadState("mine", kAnna).next_sequence(), 0);
  Restart();
  EXPECT_EQ(UploadState("mine", kAnna).next_sequence(), 0);
  EXPECT_EQ(UploadState("mine", kBert).next_sequence(), 1);
  EXPECT_EQ(Verify("mine").num_losses(), 0);
  EXPECT_EQ(Settle("mine").clouds(), 5);
}

// A restored store gives its space back just the same.
TEST_F(MapDeletionTest, AMissionOfARestoredMapGoesWithItsSpace) {
  UploadWithClouds("mine", kAnna, 1);
  UploadWithClouds("mine", kBert, 2);
  Restore("copy", Backup("mine"));
  EXPECT_GT(DeleteMission("copy", kAnna).freed_bytes(), 400'000);
  EXPECT_EQ(Verify("mine").missions(), 2);
}

TEST_F(MapDeletionTest, CloudsThatAnotherMissionRefersToStay) {
  UploadWithClouds("mine", kAnna, 1);
  UploadWithClouds("mine", kBert, 1);
  DeleteMission("mine", kAnna);
  EXPECT_EQ(Verify("mine").blobs(), 5);
  EXPECT_EQ(Settle("mine").clouds(), 5);
}

TEST_F(MapDeletionTest, WhatAnOperatorSaidOfOtherMissionsStaysSaid) {
  Submap submap = MakeSubmap(0, 0, 20);
  submap.loop_closures.push_back(MakeClosure({kAnna, 15}, {kAnna, 3}));
  {
    Uploader uploader(*mapping_, "mine", kAnna);
    ASSERT_TRUE(uploader.Read().has_ready());
    ASSERT_TRUE(uploader.Send(submap).has_ack());
  }
  Upload("mine", kBert, 1, 5);
  Settle("mine");
  v1::VetoLoopClosureRequest veto;
  veto.set_map("mine");
  veto.set_id("anna/run1:15>anna/run1:3#0");
  Call<v1::VetoLoopClosureResponse>(&v1::MapAdminService::Stub::VetoLoopClosure, veto);
  DeleteMission("mine", kBert);
  Settle("mine");
  v1::ListLoopClosuresRequest request;
  request.set_map("mine");
  const auto closures =
      Call<v1::ListLoopClosuresResponse>(&v1::MapAdminService::Stub::ListLoopClosures, request);
  ASSERT_EQ(closures.loop_closures_size(), 1);
  EXPECT_EQ(closures.loop_closures(0).verdict(), v1::LOOP_CLOSURE_VERDICT_VETOED_BY_OPERATOR);
}

TEST_F(MapDeletionTest, ARobotThatUploadsStartsTheMissionAnew) {
  Uploader uploader(*mapping_, "mine", kAnna);
  ASSERT_TRUE(uploader.Read().has_ready());
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(uploader.Send(MakeSubmap(i, 5 * i, 5)).has_ack());
  EXPECT_EQ(DeleteMission("mine", kAnna).map_epoch(), 0);  // it was the only one
  const grpc::Status status = uploader.End();
  EXPECT_EQ(status.error_code(), grpc::UNAVAILABLE);
  EXPECT_THAT(status.error_message(), HasSubstr("the map is being changed; try again"));
  Uploader again(*mapping_, "mine", kAnna);
  EXPECT_EQ(again.Read().ready().next_sequence(), 0);
  EXPECT_EQ(again.Send(MakeSubmap(0, 0, 5)).ack().durable_through_sequence(), 0);
  WaitForNodes("mine", 5);
}

// Both go on at once: nobody waits for the other for ever, and what a robot was told is stored
// since its last Ready is there in the end.
TEST_F(MapDeletionTest, DeletionsAndUploadsDoNotStandInEachOthersWay) {
  Upload("mine", kBert, 1, 5);
  std::atomic<bool> stop{false};
  int64_t acknowledged = 0, streams = 0;
  std::thread robot([&] {
    while (!stop) {
      Uploader uploader(*mapping_, "mine", kAnna);
      v1::UploadSubmapsResponse answer = uploader.Read();
      if (!answer.has_ready()) continue;  // being changed just now
      ++streams;
      acknowledged = answer.ready().next_sequence();
      while (!stop) {
        answer = uploader.Send(MakeSubmap(acknowledged, 5 * acknowledged, 5));
        if (!answer.has_ack()) break;
        ++acknowledged;
      }
    }
  });
  int deleted = 0;
  for (int i = 0; i < 10; ++i) {
    v1::DeleteMissionResponse response;
    const grpc::Status status = TryDeleteMission("mine", kAnna, response);
    deleted += status.ok();
    EXPECT_TRUE(status.ok() || status.error_code() == grpc::NOT_FOUND) << status.error_message();
    const int64_t enough = i % 3;
    EXPECT_TRUE(Eventually([&] {
      v1::GetUploadStateRequest request;
      request.set_map("mine");
      *request.mutable_mission() = ToProto(kAnna);
      v1::GetUploadStateResponse state;
      grpc::ClientContext context;
      return mapping_->GetUploadState(&context, request, &state).ok() &&
             state.next_sequence() > enough;
    }));
  }
  stop = true;
  robot.join();
  EXPECT_GE(deleted, 9);  // the first may have been too early
  EXPECT_GE(UploadState("mine", kAnna).next_sequence(), acknowledged);
  EXPECT_EQ(Verify("mine").num_losses(), 0);
  std::printf("%d deletions, %ld streams\n", deleted, streams);
}

TEST_F(MapDeletionTest, WatchersComeBackToANewEpochWithoutTheMission) {
  Upload("mine", kAnna, 1, 5);
  Upload("mine", kBert, 1, 7);
  WaitForNodes("mine", 12);
  Watcher watcher(*mapping_, testing::WatchRequest("mine"));
  const v1::WatchGraphResponse before = watcher.ReadGraph();
  ASSERT_TRUE(before.has_snapshot());
  const uint64_t epoch = DeleteMission("mine", kAnna).map_epoch();
  const grpc::Status status = watcher.Finish();
  EXPECT_EQ(status.error_code(), grpc::UNAVAILABLE);
  EXPECT_THAT(status.error_message(), HasSubstr("the map is being changed"));
  v1::WatchGraphRequest request = testing::WatchRequest("mine");
  request.set_map_epoch(before.snapshot().map_epoch());
  request.set_after_revision(before.snapshot().revision());
  Watcher resumed(*mapping_, request);
  const v1::WatchGraphResponse after = resumed.ReadGraph();
  ASSERT_TRUE(after.has_snapshot());
  EXPECT_EQ(after.snapshot().map_epoch(), epoch);
  EXPECT_GT(epoch, before.snapshot().map_epoch());
  EXPECT_EQ(WaitForNodes("mine", 7).NumNodes(), 7);
}

// Its flow control window is full; it holds a frame, and must not hold the map.
TEST_F(MapDeletionTest, AWatcherThatTakesNothingDoesNotKeepTheMap) {
  Upload("mine", kAnna, 1, 2000);
  WaitForNodes("mine", 2000);
  v1::WatchGraphRequest request = testing::WatchRequest("mine");
  request.mutable_options()->set_encoding(v1::GRAPH_ENCODING_PLAIN);
  Watcher watcher(*mapping_, request);
  ASSERT_TRUE(watcher.ReadGraph().has_snapshot());
  for (int round = 0; round < 20; ++round) {
    Uploader uploader(*mapping_, "mine", {"carl", "run" + std::to_string(round)});
    ASSERT_TRUE(uploader.Read().has_ready());
    ASSERT_TRUE(uploader.Send(MakeSubmap(0, 0, 2)).has_ack());
    Settle("mine");
  }
  v1::DeleteMapResponse response;
  const grpc::Status status = TryDeleteMap("mine", response);
  EXPECT_TRUE(status.ok()) << status.error_message();
  EXPECT_THAT(Maps(), IsEmpty());
}

TEST_F(MapDeletionTest, AMapGoesWithAllItsFiles) {
  UploadWithClouds("mine", kAnna, 1);
  Upload("other", kAnna, 1, 5);
  const int64_t bytes = Verify("mine").bytes_on_disk();
  Uploader uploader(*mapping_, "mine", kAnna);
  ASSERT_TRUE(uploader.Read().has_ready());
  Watcher watcher(*mapping_, testing::WatchRequest("mine"));
  ASSERT_TRUE(watcher.ReadGraph().has_snapshot());
  v1::DeleteMapResponse response;
  const grpc::Status status = TryDeleteMap("mine", response);
  ASSERT_TRUE(status.ok()) << status.error_message();
  EXPECT_GE(response.freed_bytes(), bytes);
  EXPECT_FALSE(std::filesystem::exists(folder_.File("data/maps/mine")));
  EXPECT_EQ(uploader.End().error_code(), grpc::UNAVAILABLE);
  EXPECT_EQ(watcher.Finish().error_code(), grpc::UNAVAILABLE);
  EXPECT_THAT(Maps(), ElementsAre("other"));
  EXPECT_EQ(UploadState("other", kAnna).next_sequence(), 1);
  EXPECT_EQ(TryDeleteMap("mine", response).error_code(), grpc::NOT_FOUND);
  // Who goes on makes it anew.
  Upload("mine", kAnna, 1, 3);
  EXPECT_EQ(WaitForNodes("mine", 3).NumNodes(), 3);
  EXPECT_EQ(Verify("mine").blobs(), 0);
}

TEST_F(MapDeletionTest, TheLastMissionTakesTheMapWithIt) {
  Upload("mine", kAnna, 1, 5);
  const v1::DeleteMissionResponse response = DeleteMission("mine", kAnna);
  EXPECT_EQ(response.map_epoch(), 0);
  EXPECT_GT(response.freed_bytes(), 0);
  EXPECT_THAT(Maps(), IsEmpty());
  EXPECT_FALSE(std::filesystem::exists(folder_.File("data/maps/mine")));
}

TEST_F(MapDeletionTest, ASlipOfThePenEndsNobodysStream) {
  Uploader uploader(*mapping_, "mine", kAnna);
  ASSERT_TRUE(uploader.Read().has_ready());
  ASSERT_TRUE(uploader.Send(MakeSubmap(0, 0, 5)).has_ack());
  v1::DeleteMissionResponse response;
  grpc::Status status = TryDeleteMission("mine", kBert, response);
  EXPECT_EQ(status.error_code(), grpc::NOT_FOUND);
  EXPECT_THAT(status.error_message(), HasSubstr("there is no bert/run1 in map 'mine'"));
  status = TryDeleteMission("mine", {"Anna", "run1"}, response);
  EXPECT_EQ(status.error_code(), grpc::INVALID_ARGUMENT);
  EXPECT_THAT(status.error_message(), HasSubstr("mission.robot"));
  EXPECT_EQ(TryDeleteMission("nowhere", kAnna, response).error_code(), grpc::NOT_FOUND);
  EXPECT_TRUE(uploader.Send(MakeSubmap(1, 5, 5)).has_ack());
}

// Written by a newer server: it is not served, and only an operator may do away with it.
TEST_F(MapDeletionTest, AMapThatCannotBeOpenedCanBeDeletedOrReplaced) {
  for (const char* map : {"a", "b", "good"}) Upload(map, kAnna, 1, 5);
  const std::string file = Backup("good");
  server_.reset();
  for (const char* map : {"a", "b"}) {
    const auto database = SqliteDatabase::Open(StorePath(map), SqliteDatabase::Mode::kReadWrite);
    ASSERT_TRUE(database.ok()) << database.status();
    ASSERT_TRUE((*database)->Execute("PRAGMA user_version=99").ok());
    auto put = (*database)->Prepare("UPDATE format SET version=99, checksum=?");
    ASSERT_TRUE(put.ok());
    const std::string checksum = FormatChecksum(99);
    ASSERT_TRUE(put->BindBlob(1, checksum).Run().ok());
  }
  StartServer(DurableOptions());
  EXPECT_THAT(Maps(), ElementsAre("good"));
  v1::DeleteMapResponse deleted;
  EXPECT_TRUE(TryDeleteMap("a", deleted).ok());
  EXPECT_FALSE(std::filesystem::exists(StorePath("a")));
  v1::RestoreMapResponse restored;
  EXPECT_EQ(TryRestore("b", file, /*replace=*/false, restored).error_code(), grpc::ALREADY_EXISTS);
  EXPECT_TRUE(TryRestore("b", file, /*replace=*/true, restored).ok());
  EXPECT_THAT(Maps(), ElementsAre("b", "good"));
}

TEST_F(MapDeletionTest, InMemoryOnlyAWholeMapCanBeDeleted) {
  server_.reset();
  StartServer();
  Upload("mine", kAnna, 1, 5);
  v1::DeleteMissionResponse response;
  const grpc::Status status = TryDeleteMission("mine", kAnna, response);
  EXPECT_EQ(status.error_code(), grpc::FAILED_PRECONDITION);
  EXPECT_THAT(status.error_message(), HasSubstr("only the map as a whole can be deleted"));
  EXPECT_EQ(UploadState("mine", kAnna).next_sequence(), 1);
  v1::DeleteMapResponse deleted;
  EXPECT_TRUE(TryDeleteMap("mine", deleted).ok());
  EXPECT_THAT(Maps(), IsEmpty());
  EXPECT_EQ(UploadState("mine", kAnna).next_sequence(), 0);
}

}  // namespace
}  // namespace overtone
