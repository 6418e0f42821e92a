// SPDX-License-Identifier: Apache-2.0
// A server that goes and comes back on the same data: in order, and as after a crash. For the
// latter the new server gets a copy of the files as they were while the old one ran.
#include <filesystem>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/tests/services/mapping_server/cloud_fixture.h"
#include "overtone/tests/services/mapping_server/server_fixture.h"

namespace overtone {
namespace {

using ::testing::ElementsAre;
using testing::EncodedCloud;
using testing::MakeClosure;
using testing::MakeSubmap;
using testing::MakeSubmapWithClouds;
using testing::ServerTest;
using testing::TestOptions;
using testing::Uploader;
using testing::Watcher;
using testing::WatchRequest;
using Stub = v1::MapAdminService::Stub;

namespace fs = std::filesystem;

const MissionId kAnna = {"anna", "run1"};
const MissionId kBert = {"bert", "run1"};
const char kWrong[] = "anna/run1:18>anna/run1:0#0";

class RestartTest : public ServerTest {
 protected:
  void SetUp() override {
    fs::remove_all(folder_);
    StartServer(Options());
  }
  void TearDown() override {
    server_.reset();
    fs::remove_all(folder_);
  }

  ServerOptions Options() const {
    ServerOptions options = TestOptions();
    options.data_dir = folder_ + "/" + std::to_string(lives_);
    return options;
  }

  void StopAndStart() {
    server_.reset();
    StartServer(Options());
  }
  void CrashAndStart() {
    const std::string before = Options().data_dir;
    ++lives_;
    fs::copy(before, Options().data_dir, fs::copy_options::recursive);
    server_.reset();
    StartServer(Options());
  }

  // A loop with a wrong closure beside the right one, and a cloud that never came.
  void MakeMap() {
    Submap submap = MakeSubmapWithClouds(0, 0, 20, {EncodedCloud(1), EncodedCloud(2)});
    LoopClosure right = MakeClosure({kAnna, 15}, {kAnna, 3});
    right.from_tform_to =
        submap.keyframes[15].mission_from_body.Inverse() * submap.keyframes[3].mission_from_body;
    submap.loop_closures = {right, MakeClosure({kAnna, 18}, {kAnna, 0})};
    Uploader uploader(*mapping_, "mine", kAnna);
    ASSERT_TRUE(uploader.Read().has_ready());
    ASSERT_TRUE(uploader.Send(submap).has_ack());
    ASSERT_EQ(uploader.Read().want().sha256_size(), 2);
    v1::BlobChunk chunk;
    chunk.set_sha256(Sha256(EncodedCloud(1)));
    chunk.set_data(EncodedCloud(1));
    uploader.Write(chunk);
    ASSERT_EQ(uploader.Read().blob_result().code(), 0);
    EXPECT_TRUE(uploader.Close().ok());
    Upload("mine", kBert, 2, 7);
    Settle("mine");
  }

  v1::GetTrajectoryResponse Trajectory(const MissionId& mission) {
    v1::GetTrajectoryRequest request;
    request.set_map("mine");
    *request.mutable_mission() = ToProto(mission);
    return Call<v1::GetTrajectoryResponse>(&Stub::GetTrajectory, request);
  }
  v1::MapSummary Summary() {
    const auto maps = Call<v1::ListMapsResponse>(&Stub::ListMaps, v1::ListMapsRequest());
    EXPECT_EQ(maps.maps_size(), 1);
    return maps.maps_size() == 1 ? maps.maps(0) : v1::MapSummary();
  }
  std::vector<std::string> Verdicts() {
    v1::ListLoopClosuresRequest request;
    request.set_map("mine");
    const auto response = Call<v1::ListLoopClosuresResponse>(&Stub::ListLoopClosures, request);
    std::vector<std::string> verdicts;
    for (const v1::LoopClosureStatus& closure : response.loop_closures()) {
      verdicts.push_back(closure.id() + " " + v1::LoopClosureVerdict_Name(closure.verdict()));
    }
    return verdicts;
  }
  size_t NumRevisions() {
    v1::ListRevisionsRequest request;
    request.set_map("mine");
    return Call<v1::ListRevisionsResponse>(&Stub::ListRevisions, request).revisions_size();
  }

  const std::string folder_ = ::testing::TempDir() + "/restart_test";
  int lives_ = 0;
};

TEST_F(RestartTest, TheMapIsThereAtOnceAsItWas) {
  MakeMap();
  const v1::MapSummary before = Summary();
  const auto trajectory = Trajectory(kAnna).SerializeAsString();
  const auto verdicts = Verdicts();
  const size_t revisions = NumRevisions();
  StopAndStart();
  v1::MapSummary after = Summary();
  EXPECT_EQ(after.map_epoch(), before.map_epoch());
  EXPECT_EQ(after.revision(), before.revision());
  EXPECT_EQ(after.keyframes(), 34);
  EXPECT_EQ(after.missing_blobs(), 1);
  EXPECT_EQ(after.clouds(), 1);
  EXPECT_EQ(after.cost(), before.cost());
  EXPECT_EQ(Trajectory(kAnna).SerializeAsString(), trajectory);
  EXPECT_EQ(Verdicts(), verdicts);
  EXPECT_EQ(NumRevisions(), revisions);
  // And no revision comes of the restart alone.
  EXPECT_EQ(Settle("mine").revision(), before.revision());
}

TEST_F(RestartTest, TheRobotGoesOnWhereItWas) {
  MakeMap();
  StopAndStart();
  EXPECT_EQ(UploadState("mine", kBert).next_sequence(), 2);
  EXPECT_EQ(UploadState("mine", kBert).next_index(), 14);
  Uploader uploader(*mapping_, "mine", kBert);
  EXPECT_EQ(uploader.Read().ready().next_sequence(), 2);
  EXPECT_EQ(uploader.Read().want().sha256_size(), 0);
  // Sent again, it is acknowledged again and stored once; other content is refused.
  EXPECT_EQ(uploader.Send(MakeSubmap(1, 7, 7)).ack().durable_through_sequence(), 1);
  EXPECT_EQ(uploader.Send(MakeSubmap(1, 7, 6)).reject().code(),
            static_cast<int>(absl::StatusCode::kAlreadyExists));
  EXPECT_TRUE(uploader.Send(MakeSubmap(2, 14, 7)).has_ack());
  EXPECT_EQ(WaitForNodes("mine", 41).NumNodes(), 41);
  // The cloud that never came is still wanted.
  Uploader again(*mapping_, "mine", kAnna);
  EXPECT_EQ(again.Read().ready().next_sequence(), 1);
  EXPECT_THAT(again.Read().want().sha256(), ElementsAre(Sha256(EncodedCloud(2))));
}

TEST_F(RestartTest, AfterACrashRevisionsThatSomebodySawAreNotGivenOutAgain) {
  MakeMap();
  const v1::MapSummary before = Summary();
  CrashAndStart();
  const v1::MapSummary after = Summary();
  EXPECT_EQ(after.map_epoch(), before.map_epoch());
  EXPECT_GT(after.revision(), before.revision());
  EXPECT_EQ(UploadState("mine", kBert).next_sequence(), 2);
  EXPECT_EQ(Settle("mine").keyframes(), 34);
  const uint64_t settled = Summary().revision();
  CrashAndStart();
  EXPECT_GT(Summary().revision(), settled);
  // Whoever watched the first server takes what comes now for newer.
  v1::WatchGraphRequest request = WatchRequest("mine");
  request.set_map_epoch(before.map_epoch());
  request.set_after_revision(before.revision());
  Watcher watcher(*mapping_, request);
  const v1::WatchGraphResponse frame = watcher.ReadGraph();
  ASSERT_TRUE(frame.has_snapshot());
  EXPECT_GT(frame.snapshot().revision(), before.revision());
}

TEST_F(RestartTest, ADecisionThatWasAnsweredStandsAfterACrash) {
  MakeMap();
  v1::VetoLoopClosureRequest veto;
  veto.set_map("mine");
  veto.set_id(kWrong);
  Call<v1::VetoLoopClosureResponse>(&Stub::VetoLoopClosure, veto);
  CrashAndStart();
  Settle("mine");
  EXPECT_EQ(Verdicts()[1], std::string(kWrong) + " LOOP_CLOSURE_VERDICT_VETOED_BY_OPERATOR");
  v1::RollBackRequest back;
  back.set_map("mine");
  v1::ListRevisionsRequest list;
  list.set_map("mine");
  const auto revisions = Call<v1::ListRevisionsResponse>(&Stub::ListRevisions, list);
  back.set_revision(revisions.revisions(revisions.revisions_size() - 1).revision());
  const auto rolled = Call<v1::RollBackResponse>(&Stub::RollBack, back);
  CrashAndStart();
  EXPECT_EQ(Settle("mine").map_epoch(), rolled.map_epoch());
}

TEST_F(RestartTest, WhatWasOnlyWatchedLeavesNothing) {
  { Watcher watcher(*mapping_, WatchRequest("waited")); }
  MakeMap();
  StopAndStart();
  EXPECT_EQ(Summary().map(), "mine");
  EXPECT_FALSE(fs::exists(Options().data_dir + "/maps/waited"));
}

TEST_F(RestartTest, ASecondServerOnTheSameDataIsRefused) {
  const auto second = MappingServer::Start(Options());
  EXPECT_EQ(second.status().code(), absl::StatusCode::kFailedPrecondition);
}

}  // namespace
}  // namespace overtone
