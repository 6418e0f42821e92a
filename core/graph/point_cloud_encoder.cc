// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/graph/cloud_columns.h"
#include "overtone/core/graph/point_cloud_codec.h"

namespace overtone {
namespace {

struct CodedPoint {
  uint64_t code = 0;
  uint8_t intensity = 0;
};

int BitLength(uint64_t value) { return value == 0 ? 0 : 64 - __builtin_clzll(value); }

absl::Status CheckPoints(const PointCloud& cloud, double resolution_m) {
  if (cloud.size() > kMaxCloudPoints) {
    return absl::InvalidArgumentError(
        absl::StrCat("points: ", cloud.size(), " of them, at most ", kMaxCloudPoints));
  }
  if (!cloud.intensities.empty() && cloud.intensities.size() != cloud.size()) {
    return absl::InvalidArgumentError(absl::StrCat("intensities: ", cloud.intensities.size(),
                                                   " of them for ", cloud.size(), " points"));
  }
  const double largest_m = resolution_m * static_cast<double>(kMaxGridIndex - 1);
  for (size_t i = 0; i < cloud.size(); ++i) {
    if (cloud.points[i].allFinite() && cloud.points[i].cwiseAbs().maxCoeff() <= largest_m) continue;
    return absl::InvalidArgumentError(
        absl::StrCat("points[", i, "]: not finite, or further out than ", largest_m, " m"));
  }
  return absl::OkStatus();
}

int64_t GridIndex(float coordinate_m, double steps_per_m) {
  return std::llrint(static_cast<double>(coordinate_m) * steps_per_m);
}

absl::StatusOr<CloudGrid> GridOf(const PointCloud& cloud, double resolution_m) {
  CloudGrid grid;
  grid.resolution_m = resolution_m;
  if (cloud.empty()) return grid;
  Eigen::Array3f low = cloud.points.front();
  Eigen::Array3f high = low;
  for (const Eigen::Vector3f& point : cloud.points) {
    low = low.min(point.array());
    high = high.max(point.array());
  }
  for (int axis = 0; axis < 3; ++axis) {
    grid.lowest[axis] = GridIndex(low[axis], 1 / resolution_m);
    grid.bits[axis] = BitLength(GridIndex(high[axis], 1 / resolution_m) - grid.lowest[axis]);
    if (grid.bits[axis] <= kMaxAxisBits) continue;
    return absl::InvalidArgumentError(
        absl::StrCat("points: they extend over ", high[axis] - low[axis],
                     " m, which needs more than 2^21 steps of ", resolution_m, " m"));
  }
  return grid;
}

// One stage of a radix sort, least significant byte first: twice as fast in all as comparing.
template <typename Byte>
void SortByByte(std::vector<CodedPoint>& points, const Byte& byte) {
  std::array<size_t, 257> begin = {};
  for (const CodedPoint& point : points) ++begin[byte(point) + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<CodedPoint> sorted(points.size());
  for (const CodedPoint& point : points) sorted[begin[byte(point)]++] = point;
  points.swap(sorted);
}

std::vector<CodedPoint> SortedCodes(const PointCloud& cloud, const CloudGrid& grid) {
  const BitPermutation morton_code = MortonCode(grid, /*inverse=*/false);
  const double steps_per_m = 1 / grid.resolution_m;
  std::vector<CodedPoint> coded(cloud.size());
  for (size_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Vector3f& point = cloud.points[i];
    coded[i].code = morton_code(PackCell(GridIndex(point.x(), steps_per_m) - grid.lowest[0],
                                         GridIndex(point.y(), steps_per_m) - grid.lowest[1],
                                         GridIndex(point.z(), steps_per_m) - grid.lowest[2]));
    if (!cloud.intensities.empty()) coded[i].intensity = cloud.intensities[i];
  }
  if (!cloud.intensities.empty()) {
    SortByByte(coded, [](const CodedPoint& point) { return point.intensity; });
  }
  for (int shift = 0; shift < grid.code_bits(); shift += 8) {
    SortByByte(coded, [shift](const CodedPoint& point) { return (point.code >> shift) & 255; });
  }
  return coded;
}

}  // namespace

absl::Status CloudCodecOptions::Validate() const {
  if (resolution_m >= 1e-6 && resolution_m <= 10) return absl::OkStatus();  // false for NaN
  return absl::InvalidArgumentError(
      absl::StrCat("resolution_m: ", resolution_m, " is not in [1e-6, 10]"));
}

absl::StatusOr<std::string> EncodePointCloud(const PointCloud& cloud,
                                             const CloudCodecOptions& options) {
  RETURN_IF_ERROR(options.Validate());
  RETURN_IF_ERROR(CheckPoints(cloud, options.resolution_m));
  CloudHeader header;
  header.num_points = static_cast<int64_t>(cloud.size());
  header.has_intensities = !cloud.intensities.empty();
  ASSIGN_OR_RETURN(header.grid, GridOf(cloud, options.resolution_m));
  std::string lengths;
  std::string intensities;
  std::string remainders;
  BitWriter bits(&remainders);
  uint64_t previous = 0;
  for (const CodedPoint& point : SortedCodes(cloud, header.grid)) {
    const uint64_t difference = point.code - std::exchange(previous, point.code);
    const int length = BitLength(difference);
    lengths.push_back(static_cast<char>(length));
    if (length > 1) bits.Put(difference ^ (uint64_t{1} << (length - 1)), length - 1);
    if (header.has_intensities) intensities.push_back(static_cast<char>(point.intensity));
  }
  bits.Flush();

  ASSIGN_OR_RETURN(const std::string lengths_frame, CompressColumn(lengths));
  header.lengths_bytes = static_cast<int64_t>(lengths_frame.size());
  std::string out = WriteHeader(header) + lengths_frame;
  if (header.has_intensities) {
    ASSIGN_OR_RETURN(const std::string intensities_frame, CompressColumn(intensities));
    AppendSize(out, intensities_frame.size());
    out += intensities_frame;
  }
  return out + remainders;
}

}  // namespace overtone
