// SPDX-License-Identifier: Apache-2.0
// ExportMap as PLY: which clouds, where, how many points.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/core/graph/point_cloud_codec.h"
#include "overtone/core/graph/point_cloud_io.h"
#include "overtone/proto/conversion/geometry_conversion.h"
#include "overtone/proto/conversion/sha256.h"
#include "overtone/tests/services/mapping_server/cloud_fixture.h"
#include "overtone/tests/services/mapping_server/server_fixture.h"
#include "overtone/tests/support/temporary_directory.h"

namespace overtone {
namespace {

using ::testing::HasSubstr;
using testing::MakeSubmapWithClouds;
using testing::ServerTest;
using ::testing::StartsWith;
using testing::Uploader;

const MissionId kAnna = {"anna", "run1"};
const MissionId kBert = {"bert", "run1"};
constexpr float kTolerance = 0.01f;  // of the codec

std::string Encode(const PointCloud& cloud) { return *EncodePointCloud(cloud, {}); }

// One point each, so far ahead.
std::string Ahead(float range_m, uint8_t intensity) {
  PointCloud cloud;
  cloud.points = {{range_m, 0, 0.5f}};
  cloud.intensities = {intensity};
  return Encode(cloud);
}

class ExportCloudsTest : public ServerTest {
 protected:
  // One submap of ten keyframes, with clouds for as many of them as there are blobs.
  void UploadClouds(const MissionId& mission, const std::vector<std::string>& blobs) {
    Uploader uploader(*mapping_, "mine", mission);
    ASSERT_TRUE(uploader.Read().has_ready());
    ASSERT_TRUE(uploader.Send(MakeSubmapWithClouds(0, 0, 10, blobs)).has_ack());
    ASSERT_TRUE(uploader.Read().has_want());
    for (const std::string& blob : blobs) {
      v1::BlobChunk chunk;
      chunk.set_sha256(Sha256(blob));
      chunk.set_data(blob);
      uploader.Write(chunk);
      ASSERT_EQ(uploader.Read().blob_result().code(), 0);
    }
    ASSERT_TRUE(uploader.Close().ok());
    Settle("mine");
  }

  static v1::ExportMapRequest Ply() {
    v1::ExportMapRequest request;
    request.set_map("mine");
    request.set_format(v1::EXPORT_FORMAT_PLY);
    return request;
  }

  grpc::Status Export(const v1::ExportMapRequest& request, std::string& file) {
    grpc::ClientContext context;
    context.set_deadline(testing::Deadline());
    const auto stream = admin_->ExportMap(&context, request);
    v1::ExportMapResponse response;
    while (stream->Read(&response)) {
      EXPECT_LE(response.chunk().size(), 256u << 10);
      file += response.chunk();
    }
    return stream->Finish();
  }

  // Sorted by x.
  std::vector<std::pair<Eigen::Vector3f, int>> Points(const v1::ExportMapRequest& request,
                                                      std::string* header = nullptr) {
    std::string file;
    const grpc::Status status = Export(request, file);
    EXPECT_TRUE(status.ok()) << status.error_message();
    if (header != nullptr) *header = file.substr(0, file.find("end_header"));
    std::ofstream(folder_.File("map.ply"), std::ios::binary) << file;
    const absl::StatusOr<PointCloud> cloud = ReadPointCloud(folder_.File("map.ply"));
    EXPECT_TRUE(cloud.ok()) << cloud.status();
    std::vector<std::pair<Eigen::Vector3f, int>> points;
    for (size_t i = 0; cloud.ok() && i < cloud->size(); ++i) {
      points.emplace_back(cloud->points[i], cloud->intensities[i]);
    }
    std::sort(points.begin(), points.end(),
              [](const auto& a, const auto& b) { return a.first.x() < b.first.x(); });
    return points;
  }

  Rigid3d MapFromBody(const MissionId& mission, int index) {
    v1::GetTrajectoryRequest request;
    request.set_map("mine");
    *request.mutable_mission() = ToProto(mission);
    const auto response =
        Call<v1::GetTrajectoryResponse>(&v1::MapAdminService::Stub::GetTrajectory, request);
    return *FromProto(response.nodes(index).map_tform_body());
  }

  TemporaryDirectory folder_;
};

TEST_F(ExportCloudsTest, EveryCloudOfTheRootComponentLiesWhereItsKeyframeIs) {
  UploadClouds(kAnna, {Ahead(5, 10), Ahead(50, 20), Ahead(500, 30)});
  UploadClouds(kBert, {Ahead(7, 40)});  // nothing ties it to anna
  std::string header;
  const auto points = Points(Ply(), &header);
  ASSERT_EQ(points.size(), 3u);
  const float ranges[] = {5, 50, 500};
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d expected = MapFromBody(kAnna, i) * Eigen::Vector3d(ranges[i], 0, 0.5);
    EXPECT_LT((points[i].first - expected.cast<float>()).norm(), kTolerance);
    EXPECT_EQ(points[i].second, 10 * (i + 1));
  }
  EXPECT_THAT(header, HasSubstr("comment 3 clouds, 0 of them unreadable; 0 points left out\n"));
}

TEST_F(ExportCloudsTest, AMissionIsExportedAloneAndOnlyWithinTheRootComponent) {
  UploadClouds(kAnna, {Ahead(5, 10)});
  UploadClouds(kBert, {Ahead(7, 40)});
  v1::ExportMapRequest request = Ply();
  *request.mutable_mission() = ToProto(kAnna);
  EXPECT_EQ(Points(request).size(), 1u);
  *request.mutable_mission() = ToProto(kBert);
  std::string ignored;
  const grpc::Status status = Export(request, ignored);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::FAILED_PRECONDITION);
  EXPECT_THAT(status.error_message(), StartsWith("mission: bert/run1 is not tied"));
  *request.mutable_mission() = ToProto(MissionId{"carl", "run1"});
  EXPECT_EQ(Export(request, ignored).error_code(), grpc::StatusCode::NOT_FOUND);
}

TEST_F(ExportCloudsTest, ManyPointsComeInChunksAndNeverMoreThanAskedFor) {
  UploadClouds(kAnna, {testing::EncodedCloud(1, 40'000), testing::EncodedCloud(2, 40'000)});
  v1::ExportMapRequest request = Ply();
  const size_t all = Points(request).size();  // at 10 cm: almost none shares a cube
  EXPECT_GT(all, 79'000u);
  EXPECT_LE(all, 80'000u);
  request.set_max_points(1000);
  std::string header;
  const size_t few = Points(request, &header).size();
  EXPECT_LE(few, 1000u);
  EXPECT_GT(few, 200u);
  EXPECT_THAT(header, ::testing::Not(HasSubstr("cubes of 0.1 m")));
  request.set_max_points(0);
  request.set_voxel_m(100);
  EXPECT_LT(Points(request).size(), 20u);
}

TEST_F(ExportCloudsTest, AMapWithoutCloudsIsAFileWithoutPoints) {
  Upload("mine", kAnna, 1, 5);
  Settle("mine");
  std::string header;
  EXPECT_EQ(Points(Ply(), &header).size(), 0u);
  EXPECT_THAT(header, HasSubstr("element vertex 0\n"));
}

TEST_F(ExportCloudsTest, CloudsAreThereAlsoWhereNobodyLooksForLoops) {
  server_.reset();
  ServerOptions options = testing::TestOptions();
  options.loop_closures.enabled = false;
  StartServer(options);
  UploadClouds(kAnna, {Ahead(5, 10), Ahead(50, 20)});
  EXPECT_EQ(Points(Ply()).size(), 2u);
}

TEST_F(ExportCloudsTest, EveryBadRequestIsRefusedByField) {
  UploadClouds(kAnna, {Ahead(5, 10)});
  const auto refused = [this](const v1::ExportMapRequest& request, const std::string& field,
                              grpc::StatusCode code = grpc::StatusCode::INVALID_ARGUMENT) {
    std::string ignored;
    const grpc::Status status = Export(request, ignored);
    EXPECT_EQ(status.error_code(), code) << status.error_message();
    EXPECT_THAT(status.error_message(), StartsWith(field + ":"));
  };
  for (const double voxel_m : {-1.0, 1e-4, 101.0, std::nan(""), HUGE_VAL}) {
    v1::ExportMapRequest request = Ply();
    request.set_voxel_m(voxel_m);
    refused(request, "voxel_m");
  }
  for (const int64_t max_points : {int64_t{-1}, int64_t{10'000'001}, INT64_MIN}) {
    v1::ExportMapRequest request = Ply();
    request.set_max_points(max_points);
    refused(request, "max_points");
  }
  v1::ExportMapRequest request = Ply();
  request.mutable_mission()->set_robot("Anna");
  refused(request, "mission.robot");
  request = Ply();
  request.set_map("");
  refused(request, "map");
  request.set_map("nowhere");
  refused(request, "map", grpc::StatusCode::NOT_FOUND);
}

}  // namespace
}  // namespace overtone
