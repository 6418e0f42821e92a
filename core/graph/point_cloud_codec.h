// SPDX-License-Identifier: Apache-2.0
// Point clouds for a narrow link: one to two bytes a point at a centimetre, instead of twelve.
//
// Points are rounded to a grid, each cell is written as one Morton code (the axes' bits
// interleaved; an axis that needs no more bits drops out, so a planar scan costs a planar code),
// the codes are sorted, and the differences of neighbours are stored: their bit lengths as a
// Huffman-coded column (zstd), the bits below the leading one as they are. Sorting saves log2(N!) /
// N bits a point and is why the order of the points is lost. Morton, "A computer oriented geodetic
// data base", 1966; for octrees the same idea is Schnabel & Klein, "Octree-based Point-Cloud
// Compression", 2006.
#ifndef OVERTONE_CORE_GRAPH_POINT_CLOUD_CODEC_H_
#define OVERTONE_CORE_GRAPH_POINT_CLOUD_CODEC_H_

#include <cstdint>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "overtone/core/graph/point_cloud.h"

namespace overtone {

constexpr int64_t kMaxCloudPoints = int64_t{1} << 21;

struct CloudCodecOptions {
  // Each coordinate comes back within half of it (and a float's rounding). Below the noise of
  // ranging.
  double resolution_m = 0.01;

  absl::Status Validate() const;  // [1e-6, 10] m
};

struct CloudCodecLimits {
  // Decoding takes 15 bytes for each, whatever the encoding's size.
  int64_t max_points = kMaxCloudPoints;
};

// The same points in any order give the same bytes, and so does what decoding them gives. Points
// stay as many as they are: those that share a cell, too. InvalidArgument: a point not finite, or
// 2^22 grid steps (42 km at 1 cm) or more from the origin; an extent of 2^21 steps or more;
// above kMaxCloudPoints; intensities neither absent nor one for each point.
absl::StatusOr<std::string> EncodePointCloud(const PointCloud& cloud,
                                             const CloudCodecOptions& options);

// The points in the order of their codes. InvalidArgument for whatever EncodePointCloud could not
// have written, and for more than max_points before any memory is taken for them: safe against any
// bytes.
absl::StatusOr<PointCloud> DecodePointCloud(absl::string_view bytes,
                                            const CloudCodecLimits& limits = {});

}  // namespace overtone

#endif  // OVERTONE_CORE_GRAPH_POINT_CLOUD_CODEC_H_
