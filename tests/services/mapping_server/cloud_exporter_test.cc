// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/cloud_exporter.h"

#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <utility>

#include "absl/synchronization/notification.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/core/graph/point_cloud_io.h"
#include "overtone/tests/services/mapping_server/cloud_fixture.h"
#include "overtone/tests/services/mapping_server/server_fixture.h"
#include "overtone/tests/services/mapping_server/store_fixture.h"
#include "overtone/tests/support/temporary_directory.h"

namespace overtone {
namespace {

using ::testing::HasSubstr;

class CloudExporterTest : public ::testing::Test {
 protected:
  CloudExporterTest() : registry_(testing::TestOptions()) {
    EXPECT_TRUE(registry_.Open().ok());
    const auto map = registry_.Acquire("mine");
    EXPECT_TRUE(map.ok());
    registry_.Keep(*map);
    request_.set_map("mine");
    request_.set_format(v1::EXPORT_FORMAT_PLY);
  }

  // The status it ended with, and its file.
  struct Export {
    absl::Notification done;
    absl::Status status;
    CloudExporter::NextChunk file;
  };
  std::shared_ptr<Export> Start(CloudExporter& exporter, std::function<bool()> wanted) {
    auto result = std::make_shared<Export>();
    exporter.Start(request_, std::move(wanted),
                   [result](absl::StatusOr<CloudExporter::NextChunk> file) {
                     result->status = file.status();
                     if (file.ok()) result->file = *std::move(file);
                     result->done.Notify();
                   });
    return result;
  }

  MapRegistry registry_;
  v1::ExportMapRequest request_;
};

TEST_F(CloudExporterTest, WorkThatNobodyWantsAnyMoreEnds) {
  CloudExporter exporter(&registry_);
  const auto gone = Start(exporter, [] { return false; });
  gone->done.WaitForNotification();
  EXPECT_EQ(gone->status.code(), absl::StatusCode::kCancelled);
  const auto wanted = Start(exporter, [] { return true; });
  wanted->done.WaitForNotification();
  EXPECT_TRUE(wanted->status.ok()) << wanted->status;
}

// A peer that takes its time keeps its points in memory.
TEST_F(CloudExporterTest, PointsAreCountedUntilTheirFileIsGone) {
  const std::string blob = testing::EncodedCloud(1, 50);
  const auto map = *registry_.Find("mine");
  ASSERT_TRUE(testing::Append(map->store(),
                              testing::RecordOf({"anna", "run1"},
                                                testing::MakeSubmapWithClouds(0, 0, 3, {blob})))
                  .ok());
  ASSERT_TRUE(testing::PutBlob(map->store(), blob).ok());
  while (map->published().snapshot->missions.empty()) std::this_thread::yield();
  CloudExporter exporter(&registry_, /*max_points=*/70);
  request_.set_max_points(70);
  const auto made = Start(exporter, [] { return true; });
  made->done.WaitForNotification();
  ASSERT_TRUE(made->status.ok()) << made->status;
  const auto refused = Start(exporter, [] { return true; });
  refused->done.WaitForNotification();
  EXPECT_EQ(refused->status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(refused->status.message()),
              HasSubstr("max_points: 70 is more than the 20 that exports"));
  request_.set_max_points(20);  // as many as are left
  const auto small = Start(exporter, [] { return true; });
  small->done.WaitForNotification();
  EXPECT_TRUE(small->status.ok()) << small->status;
  made->file = nullptr;
  small->file = nullptr;
  request_.set_max_points(70);
  const auto again = Start(exporter, [] { return true; });
  again->done.WaitForNotification();
  EXPECT_TRUE(again->status.ok()) << again->status;
}

// One export in the making holds up the next, and a request that is wrong neither.
TEST_F(CloudExporterTest, ExportsAreMadeOneAfterTheOther) {
  CloudExporter exporter(&registry_);
  absl::Notification go_on;
  const auto making = Start(exporter, [&go_on] {
    go_on.WaitForNotification();
    return true;
  });
  const auto next = Start(exporter, [] { return true; });
  request_.set_max_points(-1);
  const auto wrong = Start(exporter, [] { return true; });
  EXPECT_TRUE(wrong->done.HasBeenNotified());
  EXPECT_FALSE(making->done.HasBeenNotified());
  EXPECT_FALSE(next->done.HasBeenNotified());
  go_on.Notify();
  making->done.WaitForNotification();
  next->done.WaitForNotification();
  EXPECT_TRUE(next->status.ok()) << next->status;
}

TEST(PlyFile, FarFromTheMapsOriginCoordinatesAreDoubles) {
  TemporaryDirectory folder;
  const Eigen::Vector3d utm(4'500'000.011, 5'800'000.022, 100.033);
  for (const Eigen::Vector3d& point : {Eigen::Vector3d(1.25, -2.5, 3), utm}) {
    MergedCloud cloud = {BoundedVoxelGrid(0.1, 10)};
    cloud.points.Add(point, 200);
    PlyFile ply(cloud);
    const std::string file = ply.Next();
    EXPECT_EQ(ply.Next(), "");
    EXPECT_THAT(file, HasSubstr(point == utm ? "property double x\n" : "property float x\n"));
    std::ofstream(folder.File("map.ply"), std::ios::binary) << file;
    const auto read = ReadPointCloud(folder.File("map.ply"));
    ASSERT_TRUE(read.ok()) << read.status();
    ASSERT_EQ(read->size(), 1u);
    EXPECT_EQ(read->points[0], point.cast<float>());
    EXPECT_EQ(read->intensities[0], 200);
  }
}

}  // namespace
}  // namespace overtone
