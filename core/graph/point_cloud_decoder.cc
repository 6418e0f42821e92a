// SPDX-License-Identifier: Apache-2.0
#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/graph/cloud_columns.h"
#include "overtone/core/graph/point_cloud_codec.h"

namespace overtone {
namespace {

// The bits that the remainders take. InvalidArgument: a length that no difference of codes has.
absl::StatusOr<int64_t> RemainderBits(const std::string& lengths, int code_bits) {
  int64_t bits = 0;
  for (const char length : lengths) {
    if (static_cast<uint8_t>(length) > code_bits) {
      return absl::InvalidArgumentError("encoded cloud: a difference beyond its grid");
    }
    if (length > 1) bits += length - 1;
  }
  return bits;
}

absl::Status ReadPoints(const std::string& lengths, absl::string_view remainders,
                        const CloudGrid& grid, std::vector<Eigen::Vector3f>& points) {
  const BitPermutation cell_of = MortonCode(grid, /*inverse=*/true);
  BitReader bits(remainders);
  uint64_t code = 0;
  points.reserve(lengths.size());
  for (const char length : lengths) {
    // Both below 2^63, so the sum cannot wrap before it is found too large.
    if (length > 0) code += uint64_t{1} << (length - 1) | bits.Take(length - 1);
    if (code >> grid.code_bits() != 0) {
      return absl::InvalidArgumentError("encoded cloud: a point beyond its grid");
    }
    const uint64_t cell = cell_of(code);
    Eigen::Vector3f point;
    for (int axis = 0; axis < 3; ++axis) {
      const int64_t index = grid.lowest[axis] + CellIndex(cell, axis);
      point[axis] = static_cast<float>(static_cast<double>(index) * grid.resolution_m);
    }
    points.push_back(point);
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<PointCloud> DecodePointCloud(absl::string_view bytes,
                                            const CloudCodecLimits& limits) {
  ASSIGN_OR_RETURN(const CloudHeader header, TakeHeader(bytes));
  if (header.num_points > limits.max_points) {
    return absl::InvalidArgumentError(
        absl::StrCat("encoded cloud: ", header.num_points, " points, at most ", limits.max_points));
  }
  ASSIGN_OR_RETURN(const std::string lengths,
                   TakeColumn(bytes, header.lengths_bytes, header.num_points));
  PointCloud cloud;
  if (header.has_intensities) {
    ASSIGN_OR_RETURN(const int64_t size, TakeSize(bytes));
    ASSIGN_OR_RETURN(const std::string intensities, TakeColumn(bytes, size, header.num_points));
    cloud.intensities.assign(intensities.begin(), intensities.end());
  }
  ASSIGN_OR_RETURN(const int64_t remainder_bits, RemainderBits(lengths, header.grid.code_bits()));
  if (static_cast<int64_t>(bytes.size()) != (remainder_bits + 7) / 8) {
    return absl::InvalidArgumentError("encoded cloud: not as long as its lengths say");
  }
  RETURN_IF_ERROR(ReadPoints(lengths, bytes, header.grid, cloud.points));
  return cloud;
}

}  // namespace overtone
