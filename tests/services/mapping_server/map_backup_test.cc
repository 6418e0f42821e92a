// SPDX-License-Identifier: Apache-2.0
// Backup, restore and verification of a map that is being served.
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/core/storage/sqlite_database.h"
#include "overtone/proto/conversion/geometry_conversion.h"
#include "overtone/services/mapping_server/submap_store/store_verify.h"
#include "overtone/tests/services/mapping_server/maintenance_fixture.h"

namespace overtone {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using testing::EncodedCloud;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::MakeClosure;
using testing::MakeSubmap;
using ::testing::Not;
using testing::RestoreHeaderOf;
using testing::Restorer;
using testing::Uploader;
using testing::Watcher;

const MissionId kAnna = {"anna", "run1"};
const MissionId kBert = {"bert", "run1"};

class MapBackupTest : public testing::MaintenanceTest {
 protected:
  // Anna with a loop, vetoed; Bert with clouds.
  void MakeMap() {
    Uploader uploader(*mapping_, "mine", kAnna);
    ASSERT_TRUE(uploader.Read().has_ready());
    Submap submap = MakeSubmap(0, 0, 20);
    submap.loop_closures.push_back(MakeClosure({kAnna, 15}, {kAnna, 3}));
    ASSERT_TRUE(uploader.Send(submap).has_ack());
    EXPECT_TRUE(uploader.Close().ok());
    UploadWithClouds("mine", kBert, 1);
    Settle("mine");
    v1::VetoLoopClosureRequest request;
    request.set_map("mine");
    request.set_id("anna/run1:15>anna/run1:3#0");
    Call<v1::VetoLoopClosureResponse>(&v1::MapAdminService::Stub::VetoLoopClosure, request);
    Settle("mine");
  }

  std::string Verdict(const std::string& map) {
    v1::ListLoopClosuresRequest request;
    request.set_map(map);
    const auto response =
        Call<v1::ListLoopClosuresResponse>(&v1::MapAdminService::Stub::ListLoopClosures, request);
    EXPECT_EQ(response.loop_closures_size(), 1);
    return v1::LoopClosureVerdict_Name(response.loop_closures(0).verdict());
  }

  void ExpectSameTrajectory(const std::string& a, const std::string& b, const MissionId& mission) {
    const auto left = Trajectory(a, mission), right = Trajectory(b, mission);
    EXPECT_EQ(left.anchored(), right.anchored());
    ASSERT_EQ(left.nodes_size(), right.nodes_size());
    for (int i = 0; i < left.nodes_size(); ++i) {
      EXPECT_EQ(left.nodes(i).stamp_ns(), right.nodes(i).stamp_ns()) << i;
      const auto map_from_left = FromProto(left.nodes(i).map_tform_body());
      const auto map_from_right = FromProto(right.nodes(i).map_tform_body());
      ASSERT_TRUE(map_from_left.ok() && map_from_right.ok()) << i;
      EXPECT_LT(Log(map_from_left->Inverse() * *map_from_right).norm(), 1e-9) << i;
    }
  }

  // The code with which a restore of `requests` is refused; nothing may be left of it.
  grpc::Status Refusal(const std::vector<v1::RestoreMapRequest>& requests) {
    Restorer restorer(*admin_);
    for (const v1::RestoreMapRequest& request : requests) {
      if (!restorer.Write(request)) break;
    }
    const grpc::Status status = restorer.Finish();
    EXPECT_EQ(Transfers(), 0);
    EXPECT_THAT(Maps(), Not(::testing::Contains("new")));
    EXPECT_FALSE(std::filesystem::exists(StorePath("new")));
    return status;
  }
};

v1::RestoreMapRequest Chunk(const std::string& bytes) {
  v1::RestoreMapRequest request;
  request.set_chunk(bytes);
  return request;
}

TEST_F(MapBackupTest, ABackupIsAWholeStoreAndNothingOfItStaysBehind) {
  MakeMap();
  const std::string path = folder_.File("backup.db");
  std::ofstream(path, std::ios::binary) << Backup("mine");
  const auto report = VerifyStoreFile(path);
  ASSERT_TRUE(report.ok()) << report.status();
  EXPECT_EQ(report->missions, 2);
  EXPECT_EQ(report->submaps, 2);
  EXPECT_EQ(report->blobs, 5);
  EXPECT_THAT(report->losses, IsEmpty());
  EXPECT_EQ(Transfers(), 0);
}

TEST_F(MapBackupTest, UnderAnotherNameItIsTheSameMapInAnEpochOfItsOwn) {
  MakeMap();
  const v1::RestoreMapResponse restored = Restore("copy", Backup("mine"));
  EXPECT_EQ(restored.report().missions(), 2);
  EXPECT_EQ(restored.report().submaps(), 2);
  EXPECT_EQ(restored.report().blobs(), 5);
  EXPECT_EQ(restored.report().num_losses(), 0);
  EXPECT_THAT(Maps(), ElementsAre("copy", "mine"));
  const v1::MapSummary copy = Settle("copy");
  EXPECT_EQ(copy.map_epoch(), restored.map_epoch());
  EXPECT_GT(copy.map_epoch(), Settle("mine").map_epoch());
  EXPECT_EQ(copy.clouds(), 5);
  EXPECT_EQ(Verdict("copy"), "LOOP_CLOSURE_VERDICT_VETOED_BY_OPERATOR");
  for (const MissionId& mission : {kAnna, kBert}) ExpectSameTrajectory("mine", "copy", mission);
  EXPECT_EQ(Transfers(), 0);
}

TEST_F(MapBackupTest, ARestoredMapGoesOnAndIsThereAfterARestart) {
  MakeMap();
  Restore("copy", Backup("mine"));
  {
    Uploader uploader(*mapping_, "copy", kAnna);
    EXPECT_EQ(uploader.Read().ready().next_sequence(), 1);
    EXPECT_TRUE(uploader.Read().has_want());  // nothing is lacking
    EXPECT_TRUE(uploader.Send(MakeSubmap(1, 20, 5)).has_ack());
  }
  Restart();
  EXPECT_EQ(UploadState("copy", kAnna).next_sequence(), 2);
  EXPECT_EQ(UploadState("mine", kAnna).next_sequence(), 1);
  EXPECT_EQ(Verify("copy").num_losses(), 0);
}

TEST_F(MapBackupTest, ReplacedTheMapIsAsItWasAndItsStreamsComeBackToIt) {
  Upload("mine", kAnna, 2, 5);
  WaitForNodes("mine", 10);
  const std::string file = Backup("mine");
  const uint64_t epoch = Settle("mine").map_epoch();
  Uploader uploader(*mapping_, "mine", kAnna);
  EXPECT_EQ(uploader.Read().ready().next_sequence(), 2);
  EXPECT_TRUE(uploader.Read().has_want());
  EXPECT_TRUE(uploader.Send(MakeSubmap(2, 10, 5)).has_ack());
  Watcher watcher(*mapping_, testing::WatchRequest("mine"));
  ASSERT_TRUE(watcher.ReadGraph().has_snapshot());

  const v1::RestoreMapResponse restored = Restore("mine", file, /*replace=*/true);
  EXPECT_GT(restored.map_epoch(), epoch);
  for (const grpc::Status& status : {uploader.End(), watcher.Finish()}) {
    EXPECT_EQ(status.error_code(), grpc::UNAVAILABLE);
    EXPECT_THAT(status.error_message(), HasSubstr("the map is being changed; try again"));
  }
  Uploader again(*mapping_, "mine", kAnna);
  EXPECT_EQ(again.Read().ready().next_sequence(), 2);
  // Who resumes from the former epoch is sent the whole graph.
  v1::WatchGraphRequest request = testing::WatchRequest("mine");
  request.set_map_epoch(epoch);
  request.set_after_revision(1000);
  Watcher resumed(*mapping_, request);
  const v1::WatchGraphResponse frame = resumed.ReadGraph();
  ASSERT_TRUE(frame.has_snapshot()) << frame.ShortDebugString();
  EXPECT_EQ(frame.snapshot().map_epoch(), restored.map_epoch());
}

// The mark beside the store knows of more than the backup holds: no loss may be seen in that.
TEST_F(MapBackupTest, TheSameBackupCanBeRestoredAgainAndAgain) {
  Upload("mine", kAnna, 1, 5);
  const std::string file = Backup("mine");
  for (int round = 0; round < 3; ++round) {
    Restore("mine", file, /*replace=*/true);
    Uploader uploader(*mapping_, "mine", kAnna);
    ASSERT_EQ(uploader.Read().ready().next_sequence(), 1);
    ASSERT_TRUE(uploader.Read().has_want());  // nothing is lacking
    ASSERT_TRUE(uploader.Send(MakeSubmap(1, 5, 5)).has_ack());
    EXPECT_EQ(Verify("mine").num_losses(), 0);
  }
  Restart();
  EXPECT_EQ(Verify("mine").num_losses(), 0);
  EXPECT_EQ(UploadState("mine", kAnna).next_sequence(), 2);
}

TEST_F(MapBackupTest, AMapThatIsThereIsNotReplacedUnasked) {
  Upload("mine", kAnna, 1, 5);
  const uint64_t epoch = Settle("mine").map_epoch();
  const std::string file = Backup("mine");
  // Said to the header alone.
  const grpc::Status status = Refusal({RestoreHeaderOf("mine", file)});
  EXPECT_EQ(status.error_code(), grpc::ALREADY_EXISTS);
  EXPECT_THAT(status.error_message(), HasSubstr("there is a 'mine' already"));
  EXPECT_EQ(Settle("mine").map_epoch(), epoch);
}

TEST_F(MapBackupTest, WhatIsTooLargeIsRefusedBeforeAnythingIsWritten) {
  ServerOptions options = DurableOptions();
  options.limits.max_restore_bytes = 1 << 20;
  server_.reset();
  StartServer(options);
  v1::RestoreMapRequest header = RestoreHeaderOf("new", "x");
  header.mutable_header()->set_total_bytes((1 << 20) + 1);
  const grpc::Status status = Refusal({header});
  EXPECT_EQ(status.error_code(), grpc::RESOURCE_EXHAUSTED);
  EXPECT_THAT(status.error_message(), HasSubstr("limits.max_restore_bytes"));
}

TEST_F(MapBackupTest, WhatTheDiskCannotHoldIsRefusedBeforeAnythingIsWritten) {
  ServerOptions options = DurableOptions();
  options.limits.max_restore_bytes = int64_t{1} << 40;
  server_.reset();
  StartServer(options);
  v1::RestoreMapRequest header = RestoreHeaderOf("new", "x");
  header.mutable_header()->set_total_bytes(int64_t{1} << 40);
  const grpc::Status status = Refusal({header});
  EXPECT_EQ(status.error_code(), grpc::RESOURCE_EXHAUSTED);
  EXPECT_THAT(status.error_message(), HasSubstr("bytes left"));
}

TEST_F(MapBackupTest, EveryMistakeInTheStreamIsNamed) {
  Upload("mine", kAnna, 1, 5);
  const std::string file = Backup("mine");
  const auto expect = [&](const std::vector<v1::RestoreMapRequest>& requests,
                          const std::string& what) {
    const grpc::Status status = Refusal(requests);
    EXPECT_EQ(status.error_code(), grpc::INVALID_ARGUMENT) << what;
    EXPECT_THAT(status.error_message(), HasSubstr(what));
  };
  const v1::RestoreMapRequest header = RestoreHeaderOf("new", file);
  expect({}, "header: the stream ended before it");
  expect({Chunk(file)}, "header: the first message must have it");
  expect({header, header}, "header: the first message must have it, and no other may");
  expect({header, Chunk(file.substr(1))}, "header.total_bytes: ");
  expect({header, Chunk(file + "x")}, "chunk: more than");
  expect({header, Chunk(file.substr(1) + "x")}, "header.sha256: is not that");
  expect({header, Chunk(std::string((256 << 10) + 1, 'x'))}, "chunk: 262145 bytes, at most 256");
  v1::RestoreMapRequest bad = RestoreHeaderOf("New", file);
  expect({bad}, "header.map: ");
  bad = header;
  bad.mutable_header()->set_sha256("short");
  expect({bad}, "header.sha256: 5 bytes, not 32");
  for (const int64_t bytes : {int64_t{0}, int64_t{-1}}) {
    bad = header;
    bad.mutable_header()->set_total_bytes(bytes);
    expect({bad}, "header.total_bytes: ");
  }
}

TEST_F(MapBackupTest, AFileThatIsNoBackupChangesNothing) {
  Upload("mine", kAnna, 1, 5);
  const uint64_t epoch = Settle("mine").map_epoch();
  std::string damaged = Backup("mine");
  for (size_t at = 4096; at < 8192; ++at) damaged[at] = static_cast<char>(~damaged[at]);
  Uploader uploader(*mapping_, "mine", kAnna);
  EXPECT_TRUE(uploader.Read().has_ready());
  EXPECT_TRUE(uploader.Read().has_want());
  for (const std::string& file : {std::string("no store at all"), std::string(50'000, '\0'),
                                  damaged, damaged.substr(0, damaged.size() / 2)}) {
    v1::RestoreMapResponse response;
    const grpc::Status status = TryRestore("mine", file, /*replace=*/true, response);
    EXPECT_EQ(status.error_code(), grpc::DATA_LOSS) << status.error_message();
    EXPECT_THAT(status.error_message(), HasSubstr("the file is no backup that can be restored: "));
    EXPECT_THAT(status.error_message(), Not(HasSubstr(folder_.path())));
    EXPECT_EQ(Transfers(), 0);
  }
  // Not even its streams have noticed.
  EXPECT_TRUE(uploader.Send(MakeSubmap(1, 5, 5)).has_ack());
  EXPECT_EQ(Settle("mine").map_epoch(), epoch);
}

TEST_F(MapBackupTest, ARestoreThatBreaksOffLeavesNothing) {
  MakeMap();
  const std::string file = Backup("mine");
  ASSERT_GT(file.size(), 300u << 10);
  Restorer restorer(*admin_);
  ASSERT_TRUE(restorer.Write(RestoreHeaderOf("new", file)));
  ASSERT_TRUE(restorer.WriteChunk(file.substr(0, 200 << 10)));
  ASSERT_TRUE(Eventually([&] { return Transfers() == 1; }));
  restorer.Cancel();
  EXPECT_EQ(restorer.Finish().error_code(), grpc::CANCELLED);
  EXPECT_TRUE(Eventually([&] { return Transfers() == 0; }));
  EXPECT_THAT(Maps(), ElementsAre("mine"));
  EXPECT_FALSE(std::filesystem::exists(StorePath("new")));
}

TEST_F(MapBackupTest, ABackupThatNobodyTakesLeavesNothing) {
  for (int seed = 1; seed <= 4; ++seed) {
    UploadWithClouds("mine", {"anna", "run" + std::to_string(seed)}, seed);
  }
  v1::BackupMapRequest request;
  request.set_map("mine");
  grpc::ClientContext context;
  context.set_deadline(testing::Deadline());
  // A window that does not grow: most of it stays with the server until somebody takes it.
  grpc::ChannelArguments arguments;
  arguments.SetInt(GRPC_ARG_HTTP2_BDP_PROBE, 0);
  const auto admin = v1::MapAdminService::NewStub(
      grpc::CreateCustomChannel(server_->address(), grpc::InsecureChannelCredentials(), arguments));
  const auto stream = admin->BackupMap(&context, request);
  v1::BackupMapResponse response;
  ASSERT_TRUE(stream->Read(&response));
  ASSERT_GT(response.header().total_bytes(), 1 << 20);
  EXPECT_EQ(Transfers(), 1);
  context.TryCancel();
  EXPECT_EQ(stream->Finish().error_code(), grpc::CANCELLED);
  EXPECT_TRUE(Eventually([&] { return Transfers() == 0; }));
}

TEST_F(MapBackupTest, OnlySoManyTransfersAreUnderWayAtATime) {
  Upload("mine", kAnna, 1, 5);
  const std::string file = Backup("mine");
  std::vector<std::unique_ptr<Restorer>> restorers;
  for (int i = 0; i < 4; ++i) {
    restorers.push_back(std::make_unique<Restorer>(*admin_));
    ASSERT_TRUE(restorers.back()->Write(RestoreHeaderOf("new" + std::to_string(i), file)));
    ASSERT_TRUE(Eventually([&] { return Transfers() == i + 1; }));
  }
  std::string ignored;
  const grpc::Status status = TryBackup("mine", ignored);
  EXPECT_EQ(status.error_code(), grpc::RESOURCE_EXHAUSTED);
  EXPECT_THAT(status.error_message(), HasSubstr("4 backups and restores are under way"));
  EXPECT_EQ(Transfers(), 4);
  restorers.pop_back();
  // Its files go first, and then its place.
  std::string again;
  EXPECT_TRUE(Eventually([&] { return TryBackup("mine", again).ok(); }));
  EXPECT_EQ(again.size(), file.size());
}

TEST_F(MapBackupTest, WhatAKilledServerLeftOfATransferIsClearedAway) {
  server_.reset();
  std::filesystem::create_directories(folder_.File("data/transfers/overtone-abcdef"));
  std::ofstream(folder_.File("data/transfers/overtone-abcdef/map.db")) << "half a store";
  StartServer(DurableOptions());
  EXPECT_EQ(Transfers(), 0);
}

TEST_F(MapBackupTest, AMapInMemoryCanBeBackedUpAndNotRestored) {
  const std::unique_ptr<MappingServer> durable = std::move(server_);
  const auto durable_admin = std::move(admin_);
  StartServer();
  MakeMap();
  const std::string file = Backup("mine");
  v1::RestoreMapResponse response;
  const grpc::Status status = TryRestore("copy", file, false, response);
  EXPECT_EQ(status.error_code(), grpc::FAILED_PRECONDITION);
  EXPECT_THAT(status.error_message(), HasSubstr("keeps its maps in memory"));

  Restorer restorer(*durable_admin);
  restorer.Write(RestoreHeaderOf("kept", file));
  for (size_t at = 0; at < file.size(); at += 256 << 10) {
    restorer.WriteChunk(file.substr(at, 256 << 10));
  }
  EXPECT_TRUE(restorer.Finish().ok());
  EXPECT_EQ(restorer.response().report().submaps(), 2);
  EXPECT_TRUE(std::filesystem::exists(StorePath("kept")));
}

TEST_F(MapBackupTest, VerificationCountsWhatIsThereAndNamesWhatIsLost) {
  MakeMap();
  const v1::StoreReport whole = Verify("mine");
  EXPECT_EQ(whole.missions(), 2);
  EXPECT_EQ(whole.submaps(), 2);
  EXPECT_EQ(whole.blobs(), 5);
  EXPECT_GT(whole.findings(), 0);
  EXPECT_GT(whole.bytes_on_disk(), 350'000);
  EXPECT_THAT(whole.losses(), IsEmpty());
  {
    const auto database = SqliteDatabase::Open(StorePath("mine"), SqliteDatabase::Mode::kReadWrite);
    ASSERT_TRUE(database.ok()) << database.status();
    const absl::Status status = (*database)->Execute("UPDATE blobs SET bytes=x'00' WHERE id < 3");
    ASSERT_TRUE(status.ok()) << status;
  }
  const v1::StoreReport damaged = Verify("mine");
  EXPECT_EQ(damaged.num_losses(), 2);
  EXPECT_THAT(damaged.losses(), Each(HasSubstr("cloud")));
  // Restored it says so too.
  EXPECT_EQ(Restore("copy", Backup("mine")).report().num_losses(), 2);
}

TEST_F(MapBackupTest, AMapThatIsNotThereIsSaidToBeMissing) {
  std::string file;
  EXPECT_EQ(TryBackup("nowhere", file).error_code(), grpc::NOT_FOUND);
  v1::VerifyMapRequest request;
  request.set_map("nowhere");
  v1::VerifyMapResponse response;
  EXPECT_EQ(Try(&v1::MapAdminService::Stub::VerifyMap, request, response).error_code(),
            grpc::NOT_FOUND);
}

}  // namespace
}  // namespace overtone
