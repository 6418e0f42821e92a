// SPDX-License-Identifier: Apache-2.0
// Pose graphs in g2o's text format, planar (VERTEX_SE2, EDGE_SE2) and spatial (VERTEX_SE3:QUAT,
// EDGE_SE3:QUAT).
//
// Information matrices are taken as written, for the tangent [rho; phi] of se3.h; the format, too,
// has translation first. GTSAM and Ceres' pose_graph_3d read them so, and the optima known of the
// public benchmarks are for this. g2o itself weighs the quaternion's vector part, phi / 2 to first
// order: there the same rotation block counts a quarter, and the block between rotation and
// translation a half.
#ifndef OVERTONE_CORE_GRAPH_G2O_IO_H_
#define OVERTONE_CORE_GRAPH_G2O_IO_H_

#include <cstdint>
#include <istream>
#include <ostream>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "overtone/core/graph/pose_graph.h"

namespace overtone {

struct G2oFile {
  PoseGraph graph;
  std::vector<int64_t> vertex_ids;  // of graph.poses, strictly increasing
  // True: the file was 2-D. x, y and the heading are in the plane, z points up.
  bool planar = false;
};

// How planar edges hold the three directions they know nothing of. The planar optimum is the same
// for any values; these suit a ground vehicle: 1 cm, 10 mrad.
struct G2oReadOptions {
  double out_of_plane_translation_information = 1e4;  // z [1/m^2]
  double out_of_plane_rotation_information = 1e4;     // roll and pitch [1/rad^2]

  absl::Status Validate() const;  // both finite and > 0
};

// Vertices may be missing: such a one is put behind the vertex before it, along the edge between
// ids i - 1 and i; the first of all at the identity. Edges between successive ids are odometry,
// others loop closures. FIX lines are passed over. NotFound: cannot be opened. InvalidArgument
// "path:line: what": unknown tag, planar and spatial mixed, a vertex given twice, a field missing,
// too many or not a finite number, not a pose, information not positive definite, an edge from a
// vertex to itself; "path: what": no vertex, or one that cannot be placed.
absl::StatusOr<G2oFile> ReadG2o(const std::string& path, const G2oReadOptions& options = {});
absl::StatusOr<G2oFile> ReadG2o(std::istream& in, absl::string_view name,
                                const G2oReadOptions& options = {});

// Numbers read back as they were. A planar file keeps x, y and heading only. Unavailable: cannot be
// written.
void WriteG2o(std::ostream& out, const G2oFile& file);
absl::Status WriteG2o(const std::string& path, const G2oFile& file);
// Spatial, with ids 0, 1, 2, ...
void WriteG2o(std::ostream& out, const PoseGraph& graph);
absl::Status WriteG2o(const std::string& path, const PoseGraph& graph);

}  // namespace overtone

#endif  // OVERTONE_CORE_GRAPH_G2O_IO_H_
