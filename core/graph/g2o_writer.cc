// SPDX-License-Identifier: Apache-2.0
#include <fstream>
#include <numeric>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/format_number.h"
#include "overtone/core/graph/g2o_io.h"

namespace overtone {
namespace {

// In [rho; phi]: the directions a planar file has, and all.
const std::vector<int> kPlanarDirections = {0, 1, 5};
const std::vector<int> kSpatialDirections = {0, 1, 2, 3, 4, 5};

void WritePose(std::ostream& out, const Rigid3d& pose, bool planar) {
  const auto number = [&out](double value) { out << ' ' << FormatDouble(value); };
  number(pose.translation.x());
  number(pose.translation.y());
  if (planar) {
    number(LogSO3(pose.rotation).z());
    return;
  }
  number(pose.translation.z());
  for (const double coefficient : pose.rotation.coeffs()) number(coefficient);  // x y z w
}

void WriteUpperTriangle(std::ostream& out, const Matrix6d& matrix,
                        const std::vector<int>& directions) {
  for (size_t row = 0; row < directions.size(); ++row) {
    for (size_t col = row; col < directions.size(); ++col) {
      out << ' ' << FormatDouble(matrix(directions[row], directions[col]));
    }
  }
}

G2oFile Numbered(const PoseGraph& graph) {
  G2oFile file;
  file.graph = graph;
  file.vertex_ids.resize(graph.poses.size());
  std::iota(file.vertex_ids.begin(), file.vertex_ids.end(), 0);
  return file;
}

}  // namespace

void WriteG2o(std::ostream& out, const G2oFile& file) {
  const std::vector<int>& directions = file.planar ? kPlanarDirections : kSpatialDirections;
  for (size_t i = 0; i < file.graph.poses.size(); ++i) {
    out << (file.planar ? "VERTEX_SE2 " : "VERTEX_SE3:QUAT ") << file.vertex_ids[i];
    WritePose(out, file.graph.poses[i], file.planar);
    out << '\n';
  }
  for (const PoseGraphEdge& edge : file.graph.edges) {
    out << (file.planar ? "EDGE_SE2 " : "EDGE_SE3:QUAT ") << file.vertex_ids[edge.from] << ' '
        << file.vertex_ids[edge.to];
    WritePose(out, edge.from_tform_to, file.planar);
    WriteUpperTriangle(out, edge.information, directions);
    out << '\n';
  }
}

absl::Status WriteG2o(const std::string& path, const G2oFile& file) {
  std::ofstream out(path);
  WriteG2o(out, file);
  out.flush();
  if (!out) return absl::UnavailableError(absl::StrCat(path, ": cannot be written"));
  return absl::OkStatus();
}

void WriteG2o(std::ostream& out, const PoseGraph& graph) { WriteG2o(out, Numbered(graph)); }

absl::Status WriteG2o(const std::string& path, const PoseGraph& graph) {
  return WriteG2o(path, Numbered(graph));
}

}  // namespace overtone
