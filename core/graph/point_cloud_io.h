// SPDX-License-Identifier: Apache-2.0
// Point clouds on disk: PCD v0.7 (ascii, binary) and PLY 1.0 (ascii, binary_little_endian).
//
// Fields may come in any order. x, y and z (metres, float32 or float64) are required, "intensity"
// ("scalar_intensity", as CloudCompare names it) is taken when there, everything else is skipped.
// A point that is not finite in float32 is left out. PCD's VIEWPOINT is not applied.
//
// Intensities keep the file's scale, rounded and clamped to [0, 255]; only where all of them lie in
// [0, 1] and one is a fraction, 1 stands for full scale and becomes 255.
#ifndef OVERTONE_CORE_GRAPH_POINT_CLOUD_IO_H_
#define OVERTONE_CORE_GRAPH_POINT_CLOUD_IO_H_

#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "overtone/core/graph/point_cloud.h"

namespace overtone {

// Never allocates more than a small multiple of what the file holds, whatever its header claims.
//
// NotFound: cannot be opened. InvalidArgument "path: what" or "path:line: what": not such a file, a
// header that contradicts itself or the file's size. Unimplemented: binary_compressed PCD,
// big-endian PLY. DataLoss: the source failed.
absl::StatusOr<PointCloud> ReadPointCloud(const std::string& path);

// Binary PCD: x y z, and intensity when the cloud has it, as float32, so that every reader takes
// them. What ReadPointCloud makes of it is the same cloud. Unavailable: cannot be written.
absl::Status WritePcd(const std::string& path, const PointCloud& cloud);

}  // namespace overtone

#endif  // OVERTONE_CORE_GRAPH_POINT_CLOUD_IO_H_
