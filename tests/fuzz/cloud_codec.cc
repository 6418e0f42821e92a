// SPDX-License-Identifier: Apache-2.0
// Encoded clouds, as a robot sends them.
#include "overtone/core/graph/point_cloud_codec.h"
#include "overtone/tests/fuzz/fuzz_input.h"

namespace overtone::fuzz {
namespace {

// The decoder's memory grows with this, whatever the input says; small keeps the fuzzer fast.
constexpr int64_t kMaxPoints = 1 << 14;

void Run(absl::string_view input) {
  const absl::StatusOr<PointCloud> cloud = DecodePointCloud(input, {kMaxPoints});
  if (!cloud.ok()) {
    FUZZ_CHECK(absl::IsInvalidArgument(cloud.status()), cloud.status().ToString());
    return;
  }
  FUZZ_CHECK(cloud->size() <= kMaxPoints, "more points than allowed");
  FUZZ_CHECK(cloud->intensities.empty() || cloud->intensities.size() == cloud->size(),
             "not an intensity for each point");
  for (const Eigen::Vector3f& point : cloud->points) FUZZ_CHECK(point.allFinite(), "not finite");
}

}  // namespace
}  // namespace overtone::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  overtone::fuzz::Run(overtone::fuzz::AsText(data, size));
  return 0;
}
