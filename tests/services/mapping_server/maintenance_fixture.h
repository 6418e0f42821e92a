// SPDX-License-Identifier: Apache-2.0
// A server whose maps are on disk, and the operator's calls on whole maps.
#ifndef OVERTONE_TESTS_SERVICES_MAPPING_SERVER_MAINTENANCE_FIXTURE_H_
#define OVERTONE_TESTS_SERVICES_MAPPING_SERVER_MAINTENANCE_FIXTURE_H_

#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "gtest/gtest.h"
#include "overtone/proto/conversion/sha256.h"
#include "overtone/tests/services/mapping_server/cloud_fixture.h"
#include "overtone/tests/services/mapping_server/server_fixture.h"
#include "overtone/tests/services/mapping_server/store_fixture.h"

namespace overtone::testing {

// A RestoreMap under way.
class Restorer {
 public:
  explicit Restorer(v1::MapAdminService::Stub& stub) {
    context_.set_deadline(Deadline());
    stream_ = stub.RestoreMap(&context_, &response_);
  }
  ~Restorer() { context_.TryCancel(); }

  bool Write(const v1::RestoreMapRequest& request) { return stream_->Write(request); }
  bool WriteChunk(const std::string& chunk) {
    v1::RestoreMapRequest request;
    request.set_chunk(chunk);
    return Write(request);
  }
  void Cancel() { context_.TryCancel(); }
  grpc::Status Finish() {
    stream_->WritesDone();
    return stream_->Finish();
  }
  const v1::RestoreMapResponse& response() const { return response_; }

 private:
  grpc::ClientContext context_;
  v1::RestoreMapResponse response_;
  std::unique_ptr<grpc::ClientWriter<v1::RestoreMapRequest>> stream_;
};

inline v1::RestoreMapRequest RestoreHeaderOf(const std::string& map, const std::string& file,
                                             bool replace = false) {
  v1::RestoreMapRequest request;
  request.mutable_header()->set_map(map);
  request.mutable_header()->set_total_bytes(static_cast<int64_t>(file.size()));
  request.mutable_header()->set_sha256(Sha256(file));
  request.mutable_header()->set_replace(replace);
  return request;
}

class MaintenanceTest : public ServerTest {
 protected:
  ServerOptions DurableOptions() const {
    ServerOptions options = TestOptions();
    options.data_dir = folder_.File("data");
    options.quotas.max_calls_per_s = 0;  // these tests poll
    return options;
  }
  void SetUp() override { StartServer(DurableOptions()); }
  void TearDown() override { server_.reset(); }  // before its folder goes
  void Restart() {
    server_.reset();
    StartServer(DurableOptions());
  }

  // Checks the frames on their way.
  grpc::Status TryBackup(const std::string& map, std::string& file) {
    v1::BackupMapRequest request;
    request.set_map(map);
    grpc::ClientContext context;
    context.set_deadline(Deadline());
    const auto stream = admin_->BackupMap(&context, request);
    v1::BackupMapResponse response;
    v1::BackupHeader header;
    for (bool first = true; stream->Read(&response); first = false) {
      EXPECT_EQ(response.has_header(), first);
      if (first) header = response.header();
      EXPECT_LE(response.chunk().size(), 256u << 10);
      file += response.chunk();
    }
    const grpc::Status status = stream->Finish();
    if (status.ok()) {
      EXPECT_EQ(header.total_bytes(), static_cast<int64_t>(file.size()));
      EXPECT_EQ(header.sha256(), Sha256(file));
    }
    return status;
  }
  std::string Backup(const std::string& map) {
    std::string file;
    const grpc::Status status = TryBackup(map, file);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return file;
  }

  grpc::Status TryRestore(const std::string& map, const std::string& file, bool replace,
                          v1::RestoreMapResponse& response) {
    Restorer restorer(*admin_);
    restorer.Write(RestoreHeaderOf(map, file, replace));
    for (size_t at = 0; at < file.size(); at += 256 << 10) {
      if (!restorer.WriteChunk(file.substr(at, 256 << 10))) break;
    }
    const grpc::Status status = restorer.Finish();
    response = restorer.response();
    return status;
  }
  v1::RestoreMapResponse Restore(const std::string& map, const std::string& file,
                                 bool replace = false) {
    v1::RestoreMapResponse response;
    const grpc::Status status = TryRestore(map, file, replace, response);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return response;
  }

  v1::StoreReport Verify(const std::string& map) {
    v1::VerifyMapRequest request;
    request.set_map(map);
    return Call<v1::VerifyMapResponse>(&v1::MapAdminService::Stub::VerifyMap, request).report();
  }

  grpc::Status TryDeleteMission(const std::string& map, const MissionId& mission,
                                v1::DeleteMissionResponse& response) {
    v1::DeleteMissionRequest request;
    request.set_map(map);
    *request.mutable_mission() = ToProto(mission);
    return Try(&v1::MapAdminService::Stub::DeleteMission, request, response);
  }
  v1::DeleteMissionResponse DeleteMission(const std::string& map, const MissionId& mission) {
    v1::DeleteMissionResponse response;
    const grpc::Status status = TryDeleteMission(map, mission, response);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return response;
  }
  grpc::Status TryDeleteMap(const std::string& map, v1::DeleteMapResponse& response) {
    v1::DeleteMapRequest request;
    request.set_map(map);
    return Try(&v1::MapAdminService::Stub::DeleteMap, request, response);
  }

  v1::GetTrajectoryResponse Trajectory(const std::string& map, const MissionId& mission) {
    v1::GetTrajectoryRequest request;
    request.set_map(map);
    *request.mutable_mission() = ToProto(mission);
    return Call<v1::GetTrajectoryResponse>(&v1::MapAdminService::Stub::GetTrajectory, request);
  }
  std::vector<std::string> Maps() {
    const auto response =
        Call<v1::ListMapsResponse>(&v1::MapAdminService::Stub::ListMaps, v1::ListMapsRequest());
    std::vector<std::string> names;
    for (const v1::MapSummary& map : response.maps()) names.push_back(map.map());
    return names;
  }

  // Submap 0 of five keyframes, and a cloud of about 77 kB for each of them.
  void UploadWithClouds(const std::string& map, const MissionId& mission, int seed) {
    std::vector<std::string> blobs;
    for (int i = 0; i < 5; ++i) blobs.push_back(EncodedCloud(10 * seed + i, 25'000));
    Uploader uploader(*mapping_, map, mission);
    ASSERT_TRUE(uploader.Read().has_ready());
    ASSERT_TRUE(uploader.Send(MakeSubmapWithClouds(0, 0, 5, blobs)).has_ack());
    for (const std::string& blob : blobs) {
      v1::BlobChunk chunk;
      chunk.set_sha256(Sha256(blob));
      chunk.set_data(blob);
      uploader.Write(chunk);
    }
    EXPECT_TRUE(uploader.Close().ok());
    EXPECT_EQ(UploadState(map, mission).missing_blobs(), 0);
  }

  // What happens on the server's threads and nobody is told of.
  static bool Eventually(const std::function<bool()>& condition) {
    const auto deadline = Deadline();
    while (!condition()) {
      if (std::chrono::system_clock::now() > deadline) return false;
      std::this_thread::yield();
    }
    return true;
  }
  static int Entries(const std::string& folder) {
    std::error_code error;
    int entries = 0;
    for (std::filesystem::directory_iterator it(folder, error), end; it != end; it.increment(error))
      ++entries;
    return entries;
  }
  int Transfers() const { return Entries(folder_.File("data/transfers")); }
  std::string StorePath(const std::string& map) const {
    return folder_.File("data/maps/" + map + "/map.db");
  }

  TemporaryDirectory folder_;
};

}  // namespace overtone::testing

#endif  // OVERTONE_TESTS_SERVICES_MAPPING_SERVER_MAINTENANCE_FIXTURE_H_
