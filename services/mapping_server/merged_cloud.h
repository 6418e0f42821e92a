// SPDX-License-Identifier: Apache-2.0
// The clouds of a map's root component in one, for ExportMap. Clouds come from the store one by
// one, and in memory there is never more than one of them and the thinned sum.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_MERGED_CLOUD_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_MERGED_CLOUD_H_

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "overtone/core/common/ids.h"
#include "overtone/core/registration/bounded_voxel_grid.h"
#include "overtone/services/mapping_server/map_registry.h"
#include "overtone/v1/map_admin_service.pb.h"

namespace overtone {

constexpr int64_t kMaxExportPoints = 10'000'000;

struct CloudExport {
  std::string map;
  std::optional<MissionId> mission;  // absent: all of the root component
  double voxel_m = 0.1;
  int64_t max_points = kMaxExportPoints;
};

// InvalidArgument naming the field.
absl::StatusOr<CloudExport> ReadCloudExport(const v1::ExportMapRequest& request);

struct MergedCloud {
  BoundedVoxelGrid points;
  int64_t clouds = 0;
  int64_t unreadable = 0;  // clouds that are stored, and that the store or the codec does not give
};

// By the poses of the newest revision. Takes as long as it takes to read every cloud; not for
// gRPC's threads. It holds the map for the time of one cloud at most, so that the map can be
// deleted meanwhile.
//
// NotFound: no such map or mission. FailedPrecondition: the mission is not in the root component.
// Aborted: the map was restored, rolled back or rebuilt meanwhile. Cancelled: `wanted` said no.
absl::StatusOr<MergedCloud> MergeClouds(const MapRegistry& registry, const CloudExport& request,
                                        const std::function<bool()>& wanted);

// The cloud as binary little-endian PLY, piece by piece: x y z intensity, all float. More than 10
// km from the map's origin, where floats are coarse, x y z are double.
class PlyFile {
 public:
  explicit PlyFile(MergedCloud cloud);

  // At most 256 KiB; empty at the end.
  std::string Next();

 private:
  std::string Header() const;
  void Append(const BoundedVoxelGrid::Voxel& voxel, std::string& out) const;

  const MergedCloud cloud_;
  const bool wide_;
  bool has_header_ = false;
  BoundedVoxelGrid::Voxels::const_iterator next_;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_MERGED_CLOUD_H_
