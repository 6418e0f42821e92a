// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <fstream>
#include <map>
#include <optional>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "overtone/core/common/line_reader.h"
#include "overtone/core/common/parse_number.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/geometry/parse_pose.h"
#include "overtone/core/geometry/positive_definite.h"
#include "overtone/core/graph/g2o_io.h"

namespace overtone {
namespace {

using Fields = absl::Span<const absl::string_view>;

// Upper triangle, row by row -> symmetric, positive definite.
absl::StatusOr<Eigen::MatrixXd> ParseInformation(Fields fields, int dimension) {
  std::vector<double> values(fields.size());
  RETURN_IF_ERROR(ParseFiniteDoubles(fields, absl::MakeSpan(values)));
  Eigen::MatrixXd information(dimension, dimension);
  auto value = values.begin();
  for (int row = 0; row < dimension; ++row) {
    for (int col = row; col < dimension; ++col) {
      information(row, col) = information(col, row) = *value++;
    }
  }
  if (!IsPositiveDefinite(information)) {
    return absl::InvalidArgumentError("the information matrix is not positive definite");
  }
  return information;
}

// x y heading -> in the plane z = 0, heading about z.
absl::StatusOr<Rigid3d> ParsePlanarPose(Fields fields) {
  Eigen::Vector3d v;
  RETURN_IF_ERROR(ParseFiniteDoubles(fields, absl::MakeSpan(v.data(), 3)));
  const Eigen::Quaterniond heading(std::cos(v.z() / 2), 0, 0, std::sin(v.z() / 2));
  return CheckedPose(Eigen::Vector3d(v.x(), v.y(), 0), heading.coeffs());
}

Matrix6d LiftInformation(const Eigen::Matrix3d& planar, const G2oReadOptions& options) {
  constexpr int kInSpace[] = {0, 1, 5};  // x, y, heading in [rho; phi]
  Matrix6d information = Matrix6d::Zero();
  information(2, 2) = options.out_of_plane_translation_information;
  information(3, 3) = information(4, 4) = options.out_of_plane_rotation_information;
  for (int row = 0; row < 3; ++row) {
    for (int col = 0; col < 3; ++col) {
      information(kInSpace[row], kInSpace[col]) = planar(row, col);
    }
  }
  return information;
}

struct Edge {
  int64_t from_id;
  int64_t to_id;
  Rigid3d from_tform_to;
  Matrix6d information;
};

// The lines of a file, before vertices have positions.
class LineParser {
 public:
  explicit LineParser(const G2oReadOptions& options) : options_(options) {}

  absl::Status Parse(absl::string_view line) {
    const std::vector<absl::string_view> fields =
        absl::StrSplit(line, absl::ByAnyChar(" \t"), absl::SkipEmpty());
    const absl::string_view tag = fields[0];
    if (tag == "FIX") return absl::OkStatus();
    const Fields values = absl::MakeConstSpan(fields).subspan(1);
    if (tag == "VERTEX_SE2") return ParseVertex(values, /*planar=*/true);
    if (tag == "VERTEX_SE3:QUAT") return ParseVertex(values, /*planar=*/false);
    if (tag == "EDGE_SE2") return ParseEdge(values, /*planar=*/true);
    if (tag == "EDGE_SE3:QUAT") return ParseEdge(values, /*planar=*/false);
    return absl::InvalidArgumentError(
        absl::StrCat("unknown tag '", absl::CEscape(tag.substr(0, 40)), "'"));
  }

  // By id; without a value where the file names a vertex but gives no pose.
  std::map<int64_t, std::optional<Rigid3d>>& vertices() { return vertices_; }
  const std::vector<Edge>& edges() const { return edges_; }
  bool planar() const { return planar_.value_or(false); }

 private:
  absl::Status CheckShape(Fields values, size_t expected, bool planar) {
    if (planar_.value_or(planar) != planar) {
      return absl::InvalidArgumentError("planar and spatial elements in one file");
    }
    planar_ = planar;
    if (values.size() == expected) return absl::OkStatus();
    return absl::InvalidArgumentError(
        absl::StrCat(values.size(), " fields after the tag where ", expected, " are expected"));
  }

  absl::Status ParseVertex(Fields values, bool planar) {
    RETURN_IF_ERROR(CheckShape(values, planar ? 4 : 8, planar));
    ASSIGN_OR_RETURN(const int64_t id, ParseNonNegativeInteger(values[0]));
    ASSIGN_OR_RETURN(const Rigid3d pose,
                     planar ? ParsePlanarPose(values.subspan(1)) : ParsePose(values.subspan(1)));
    std::optional<Rigid3d>& vertex = vertices_[id];
    if (vertex.has_value()) {
      return absl::InvalidArgumentError(absl::StrCat("vertex ", id, " is given twice"));
    }
    vertex = pose;
    return absl::OkStatus();
  }

  absl::Status ParseEdge(Fields values, bool planar) {
    const size_t pose_fields = planar ? 3 : 7;
    const int dimension = planar ? 3 : 6;
    RETURN_IF_ERROR(CheckShape(values, 2 + pose_fields + dimension * (dimension + 1) / 2, planar));
    Edge edge;
    ASSIGN_OR_RETURN(edge.from_id, ParseNonNegativeInteger(values[0]));
    ASSIGN_OR_RETURN(edge.to_id, ParseNonNegativeInteger(values[1]));
    if (edge.from_id == edge.to_id) {
      return absl::InvalidArgumentError(
          absl::StrCat("an edge from vertex ", edge.from_id, " to itself"));
    }
    const Fields pose = values.subspan(2, pose_fields);
    ASSIGN_OR_RETURN(edge.from_tform_to, planar ? ParsePlanarPose(pose) : ParsePose(pose));
    ASSIGN_OR_RETURN(const Eigen::MatrixXd information,
                     ParseInformation(values.subspan(2 + pose_fields), dimension));
    edge.information = planar ? LiftInformation(information, options_) : Matrix6d(information);
    vertices_.try_emplace(edge.from_id);
    vertices_.try_emplace(edge.to_id);
    edges_.push_back(edge);
    return absl::OkStatus();
  }

  const G2oReadOptions options_;
  std::optional<bool> planar_;
  std::map<int64_t, std::optional<Rigid3d>> vertices_;
  std::vector<Edge> edges_;
};

bool IsOdometry(const Edge& edge) {  // ids are >= 0: no overflow
  return edge.to_id - edge.from_id == 1 || edge.from_id - edge.to_id == 1;
}

// Gives every vertex without a pose the one that odometry leads to. InvalidArgument: no edge leads
// there.
absl::Status ComposeMissingVertices(LineParser& parser) {
  std::map<int64_t, Rigid3d> from_previous;  // by the id of the later vertex
  for (const Edge& edge : parser.edges()) {
    if (!IsOdometry(edge)) continue;
    const bool forward = edge.from_id < edge.to_id;
    from_previous.try_emplace(std::max(edge.from_id, edge.to_id),
                              forward ? edge.from_tform_to : edge.from_tform_to.Inverse());
  }
  const Rigid3d* previous = nullptr;
  for (auto& [id, pose] : parser.vertices()) {
    const auto motion = from_previous.find(id);
    if (!pose.has_value() && previous == nullptr) pose = Rigid3d::Identity();
    if (!pose.has_value() && motion != from_previous.end()) pose = *previous * motion->second;
    if (!pose.has_value()) {
      return absl::InvalidArgumentError(
          absl::StrCat("vertex ", id, " has neither a pose nor an edge from ", id - 1));
    }
    previous = &*pose;
  }
  return absl::OkStatus();
}

G2oFile Assemble(LineParser& parser) {
  G2oFile file;
  file.planar = parser.planar();
  std::map<int64_t, int> position;
  for (const auto& [id, pose] : parser.vertices()) {
    position[id] = static_cast<int>(file.vertex_ids.size());
    file.vertex_ids.push_back(id);
    file.graph.poses.push_back(*pose);
  }
  for (const Edge& edge : parser.edges()) {
    file.graph.edges.push_back({position[edge.from_id], position[edge.to_id], edge.from_tform_to,
                                edge.information,
                                IsOdometry(edge) ? EdgeKind::kOdometry : EdgeKind::kLoopClosure});
  }
  return file;
}

}  // namespace

absl::Status G2oReadOptions::Validate() const {
  for (const double information :
       {out_of_plane_translation_information, out_of_plane_rotation_information}) {
    if (!(information > 0) || !std::isfinite(information)) {
      return absl::InvalidArgumentError("out-of-plane information must be finite and > 0");
    }
  }
  return absl::OkStatus();
}

absl::StatusOr<G2oFile> ReadG2o(std::istream& in, absl::string_view name,
                                const G2oReadOptions& options) {
  RETURN_IF_ERROR(options.Validate());
  LineParser parser(options);
  LineReader reader(in, name);
  absl::string_view line;
  while (reader.Next(&line)) {
    const absl::Status status = parser.Parse(line);
    if (!status.ok()) return reader.Error(status.message());
  }
  RETURN_IF_ERROR(reader.status());
  absl::Status placed = ComposeMissingVertices(parser);
  if (parser.vertices().empty()) placed = absl::InvalidArgumentError("no vertices");
  if (!placed.ok()) return absl::InvalidArgumentError(absl::StrCat(name, ": ", placed.message()));
  return Assemble(parser);
}

absl::StatusOr<G2oFile> ReadG2o(const std::string& path, const G2oReadOptions& options) {
  std::ifstream file(path);
  if (!file) return absl::NotFoundError(absl::StrCat(path, ": cannot be opened"));
  return ReadG2o(file, path, options);
}

}  // namespace overtone
