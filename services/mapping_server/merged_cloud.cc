// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/merged_cloud.h"

#include <algorithm>
#include <cstring>
#include <memory>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/mapping/map_snapshot.h"
#include "overtone/proto/conversion/field_path.h"
#include "overtone/proto/conversion/id_conversion.h"

namespace overtone {
namespace {

constexpr double kMinVoxelM = 0.001;
constexpr double kMaxVoxelM = 100;
constexpr double kFloatsSufficeM = 10'000;  // a millimetre
constexpr size_t kChunkBytes = 256 << 10;
constexpr size_t kLargestRecordBytes = 3 * sizeof(double) + sizeof(float);

absl::StatusOr<std::vector<const SnapshotMission*>> MissionsOf(const MapSnapshot& snapshot,
                                                               const CloudExport& request) {
  std::vector<const SnapshotMission*> missions;
  for (const SnapshotMission& mission : snapshot.missions) {
    if (request.mission && mission.id != *request.mission) continue;
    if (request.mission && mission.component != 0) {
      return absl::FailedPreconditionError(
          absl::StrCat("mission: ", ToString(mission.id),
                       " is not tied to the map's root component, whose frame the cloud is in"));
    }
    if (mission.component == 0) missions.push_back(&mission);
  }
  if (request.mission && missions.empty()) {
    return absl::NotFoundError(absl::StrCat("mission: no ", ToString(*request.mission),
                                            " in revision ", snapshot.revision));
  }
  return missions;
}

void AddCloud(const PointCloud& cloud, const Rigid3d& map_from_body, BoundedVoxelGrid& points) {
  const Eigen::Matrix3d rotation = map_from_body.rotation.toRotationMatrix();
  for (size_t i = 0; i < cloud.size(); ++i) {
    const float intensity = cloud.intensities.empty() ? 0 : cloud.intensities[i];
    points.Add(rotation * cloud.points[i].cast<double>() + map_from_body.translation, intensity);
  }
}

template <typename Number>
void AppendBytes(Number number, std::string& out) {
  static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__);
  char bytes[sizeof(Number)];
  std::memcpy(bytes, &number, sizeof(Number));
  out.append(bytes, sizeof(Number));
}

}  // namespace

absl::StatusOr<CloudExport> ReadCloudExport(const v1::ExportMapRequest& request) {
  CloudExport result;
  RETURN_IF_ERROR(ValidateId(request.map(), "map"));
  result.map = request.map();
  if (request.has_mission()) {
    ASSIGN_OR_RETURN(result.mission, AtField("mission", FromProto(request.mission())));
  }
  if (request.voxel_m() != 0) result.voxel_m = request.voxel_m();
  if (!(result.voxel_m >= kMinVoxelM && result.voxel_m <= kMaxVoxelM)) {
    return InvalidField("voxel_m", absl::StrCat(request.voxel_m(), " is not in [", kMinVoxelM, ", ",
                                                kMaxVoxelM, "], nor 0 for the default"));
  }
  if (request.max_points() != 0) result.max_points = request.max_points();
  if (result.max_points < 1 || result.max_points > kMaxExportPoints) {
    return InvalidField(
        "max_points", absl::StrCat(request.max_points(), " is not in [0, ", kMaxExportPoints, "]"));
  }
  return result;
}

absl::StatusOr<MergedCloud> MergeClouds(const MapRegistry& registry, const CloudExport& request,
                                        const std::function<bool()>& wanted) {
  if (!wanted()) return absl::CancelledError("the peer is gone");
  std::shared_ptr<const MapSnapshot> snapshot;
  {
    ASSIGN_OR_RETURN(const std::shared_ptr<HostedMap> map, registry.Find(request.map));
    snapshot = map->published().snapshot;
  }
  ASSIGN_OR_RETURN(const std::vector<const SnapshotMission*> missions,
                   MissionsOf(*snapshot, request));
  MergedCloud merged = {BoundedVoxelGrid(request.voxel_m, request.max_points)};
  for (const SnapshotMission* mission : missions) {
    for (size_t i = 0; i < mission->map_from_body.size(); ++i) {
      if (!wanted()) return absl::CancelledError("the peer is gone");
      ASSIGN_OR_RETURN(const std::shared_ptr<HostedMap> map, registry.Find(request.map));
      if (map->epoch() != snapshot->map_epoch) {
        return absl::AbortedError("map: it was changed as a whole meanwhile; try again");
      }
      const NodeId node = {mission->id, static_cast<int64_t>(i)};
      const CloudLibrary& library = map->detector().clouds();
      if (!library.HasCloud(node)) continue;
      ++merged.clouds;
      const absl::StatusOr<PlaceView> scan = library.Scan(node);
      if (scan.ok()) {
        AddCloud(*scan->cloud, mission->map_from_body[i], merged.points);
      } else {
        ++merged.unreadable;
      }
    }
  }
  return merged;
}

PlyFile::PlyFile(MergedCloud cloud)
    : cloud_(std::move(cloud)),
      wide_(cloud_.points.origin().cwiseAbs().maxCoeff() > kFloatsSufficeM),
      next_(cloud_.points.voxels().begin()) {}

std::string PlyFile::Header() const {
  const char* type = wide_ ? "double" : "float";
  std::string header =
      absl::StrCat("ply\nformat binary_little_endian 1.0\ncomment map frame, metres; cubes of ",
                   cloud_.points.voxel_m(), " m\ncomment ", cloud_.clouds, " clouds, ",
                   cloud_.unreadable, " of them unreadable; ", cloud_.points.left_out(),
                   " points left out\nelement vertex ", cloud_.points.voxels().size(), "\n");
  for (const char* axis : {"x", "y", "z"}) {
    absl::StrAppend(&header, "property ", type, " ", axis, "\n");
  }
  absl::StrAppend(&header, "property float intensity\nend_header\n");
  return header;
}

void PlyFile::Append(const BoundedVoxelGrid::Voxel& voxel, std::string& out) const {
  const Eigen::Vector3d point = cloud_.points.origin() + voxel.mean.cast<double>();
  for (const double coordinate : {point.x(), point.y(), point.z()}) {
    if (wide_) {
      AppendBytes(coordinate, out);
    } else {
      AppendBytes(static_cast<float>(coordinate), out);
    }
  }
  AppendBytes(voxel.intensity, out);
}

std::string PlyFile::Next() {
  std::string chunk;
  if (!has_header_) chunk = Header();
  has_header_ = true;
  while (next_ != cloud_.points.voxels().end() &&
         chunk.size() + kLargestRecordBytes <= kChunkBytes) {
    Append(next_->second, chunk);
    ++next_;
  }
  return chunk;
}

}  // namespace overtone
