// SPDX-License-Identifier: Apache-2.0
// PCD and PLY: what is read can be written, and reads back as it was.
#include "overtone/core/graph/point_cloud_io.h"
#include "overtone/tests/fuzz/memory_file.h"

namespace overtone::fuzz {
namespace {

void Run(absl::string_view input) {
  const absl::StatusOr<PointCloud> cloud = ReadPointCloud(MemoryFile(input).path());
  if (!cloud.ok()) return;
  FUZZ_CHECK(cloud->intensities.empty() || cloud->intensities.size() == cloud->size(),
             "not an intensity for each point");
  for (const Eigen::Vector3f& point : cloud->points) FUZZ_CHECK(point.allFinite(), "not finite");
  const MemoryFile written("");
  FUZZ_CHECK(WritePcd(written.path(), *cloud).ok(), "cannot be written");
  const absl::StatusOr<PointCloud> again = ReadPointCloud(written.path());
  FUZZ_CHECK(again.ok(), again.status().ToString());
  FUZZ_CHECK(again->points == cloud->points, "points changed");
  FUZZ_CHECK(again->intensities == cloud->intensities, "intensities changed");
}

}  // namespace
}  // namespace overtone::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  overtone::fuzz::Run(overtone::fuzz::AsText(data, size));
  return 0;
}
