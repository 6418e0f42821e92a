// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/cloud_exporter.h"

#include <fstream>
#include <memory>
#include <string>

#include "absl/synchronization/notification.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/core/graph/point_cloud_io.h"
#include "overtone/tests/services/mapping_server/server_fixture.h"
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

// Two of full size: one in the making, one made whose reader takes its time.
TEST_F(CloudExporterTest, MemoryIsReservedUntilTheFileIsGone) {
  CloudExporter exporter(&registry_);
  const auto made = Start(exporter, [] { return true; });
  made->done.WaitForNotification();
  ASSERT_TRUE(made->status.ok());
  absl::Notification go_on;
  const auto making = Start(exporter, [&go_on] {
    go_on.WaitForNotification();
    return true;
  });
  const auto refused = Start(exporter, [] { return true; });
  ASSERT_TRUE(refused->done.HasBeenNotified());  // at once
  EXPECT_EQ(refused->status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(refused->status.message()), HasSubstr("max_points"));
  made->file = nullptr;
  const auto next = Start(exporter, [] { return true; });
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
