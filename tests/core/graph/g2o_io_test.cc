// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/graph/g2o_io.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>

#include "Eigen/Eigenvalues"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace overtone {
namespace {

using ::testing::ElementsAre;

absl::StatusOr<G2oFile> Parse(const std::string& text, const G2oReadOptions& options = {}) {
  std::istringstream in(text);
  return ReadG2o(in, "file", options);
}

// Upper triangle of a full, positive definite 6 x 6 matrix: diagonal 21..26, entry k of the
// triangle elsewhere.
constexpr char kSpatialInformation[] =
    " 21 .1 .2 .3 .4 .5"
    " 22 .6 .7 .8 .9"
    " 23 1.0 1.1 1.2"
    " 24 1.3 1.4"
    " 25 1.5"
    " 26";

std::string SpatialEdge(const std::string& ids_and_pose) {
  return "EDGE_SE3:QUAT " + ids_and_pose + kSpatialInformation + "\n";
}

TEST(ReadG2o, ReadsSpatialVerticesAndEdges) {
  const auto file = Parse(
      "VERTEX_SE3:QUAT 7 1 2 3 0 0 0.6 0.8 \n"
      "FIX 7\n"
      "VERTEX_SE3:QUAT 3 -1 0 0 0 0 0 1\n" +
      SpatialEdge("3 7 4 5 6 0.6 0 0 -0.8"));
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_FALSE(file->planar);
  EXPECT_THAT(file->vertex_ids, ElementsAre(3, 7));
  EXPECT_EQ(file->graph.poses[1].translation, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(file->graph.poses[1].rotation.z(), 0.6);

  ASSERT_EQ(file->graph.edges.size(), 1u);
  const PoseGraphEdge& edge = file->graph.edges[0];
  EXPECT_EQ(edge.from, 0);
  EXPECT_EQ(edge.to, 1);
  EXPECT_EQ(edge.kind, EdgeKind::kLoopClosure) << "3 and 7 do not follow each other";
  EXPECT_EQ(edge.from_tform_to.translation, Eigen::Vector3d(4, 5, 6));
  EXPECT_EQ(edge.from_tform_to.rotation.coeffs(), Eigen::Vector4d(0.6, 0, 0, -0.8));
  // Row by row: the translation's block first, the rotation's last, both halves filled.
  EXPECT_EQ(edge.information.diagonal(), (Vector6d() << 21, 22, 23, 24, 25, 26).finished());
  EXPECT_EQ(edge.information(0, 5), 0.5);
  EXPECT_EQ(edge.information(1, 2), 0.6);
  EXPECT_EQ(edge.information(5, 4), 1.5);
  EXPECT_EQ(edge.information, edge.information.transpose());
}

TEST(ReadG2o, LiftsPlanarOnesIntoSpaceWithZUp) {
  const auto file = Parse(
      "VERTEX_SE2 0 1 2 0.5\n"
      "VERTEX_SE2 1 2 2 -3\n"
      "EDGE_SE2 0 1 0.9 -0.1 0.3  10 1 2 20 3 30\n",
      {/*out_of_plane_translation_information=*/5, /*out_of_plane_rotation_information=*/7});
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_TRUE(file->planar);
  EXPECT_EQ(file->graph.poses[0].translation, Eigen::Vector3d(1, 2, 0));
  EXPECT_LT((LogSO3(file->graph.poses[1].rotation) - Eigen::Vector3d(0, 0, -3)).norm(), 1e-15);

  const PoseGraphEdge& edge = file->graph.edges[0];
  EXPECT_EQ(edge.kind, EdgeKind::kOdometry);
  EXPECT_EQ(edge.from_tform_to.translation, Eigen::Vector3d(0.9, -0.1, 0));
  EXPECT_NEAR(LogSO3(edge.from_tform_to.rotation).z(), 0.3, 1e-15);
  Matrix6d expected = Matrix6d::Zero();
  expected.diagonal() << 10, 20, 5, 7, 7, 30;
  expected(0, 1) = expected(1, 0) = 1;
  expected(0, 5) = expected(5, 0) = 2;
  expected(1, 5) = expected(5, 1) = 3;
  EXPECT_EQ(edge.information, expected);
}

TEST(ReadG2o, ComposesMissingVerticesAlongSuccessiveEdges) {
  // 0 -> 1 forward, 1 -> 2 given from 2 to 1; 0-2 is a loop closure and is not followed.
  const auto file = Parse(
      "EDGE_SE2 0 2 9 9 0  1 0 0 1 0 1\n"
      "EDGE_SE2 0 1 1 0 1.5707963267948966  1 0 0 1 0 1\n"
      "EDGE_SE2 2 1 -2 0 0  1 0 0 1 0 1\n");
  ASSERT_TRUE(file.ok()) << file.status();
  ASSERT_EQ(file->graph.poses.size(), 3u);
  EXPECT_EQ(file->graph.poses[0].translation, Eigen::Vector3d(0, 0, 0));
  EXPECT_LT((file->graph.poses[1].translation - Eigen::Vector3d(1, 0, 0)).norm(), 1e-15);
  EXPECT_LT((file->graph.poses[2].translation - Eigen::Vector3d(1, 2, 0)).norm(), 1e-15);
  EXPECT_EQ(file->graph.edges[0].kind, EdgeKind::kLoopClosure);
  EXPECT_EQ(file->graph.edges[2].kind, EdgeKind::kOdometry);
}

TEST(ReadG2o, ComposesBehindAVertexThatIsGiven) {
  const auto file = Parse(
      "VERTEX_SE2 4 10 0 0\n"
      "EDGE_SE2 4 5 1 0 0  1 0 0 1 0 1\n");
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_EQ(file->graph.poses[1].translation, Eigen::Vector3d(11, 0, 0));
}

TEST(ReadG2o, RefusesBadInputAndNamesTheLine) {
  const std::string vertex = "VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\n";
  const std::string planar_edge = "EDGE_SE2 0 1 1 0 0  1 0 0 1 0 1\n";
  const std::vector<std::array<std::string, 3>> cases = {
      // why, text, how the error begins
      {"nothing", "", "file: no vertices"},
      {"only comments", "# a\n\nFIX 0\n", "file: no vertices"},
      {"unknown tag", vertex + "VERTEX_XY 1 2 3\n", "file:2: unknown tag 'VERTEX_XY'"},
      {"binary", "\x7f\x45\x4c\x46\xff\n", "file:1: unknown tag '\\177ELF\\377'"},
      {"only a tag", "VERTEX_SE2", "file:1: 0 fields after the tag where 4 are expected"},
      {"truncated vertex", vertex + "VERTEX_SE3:QUAT 1 0 0 0 0 0", "file:2: 6 fields"},
      {"too many fields", "VERTEX_SE2 0 0 0 0 0\n", "file:1: 5 fields"},
      {"truncated edge", "EDGE_SE2 0 1 1 0 0 1 0 0 1 0\n",
       "file:1: 10 fields after the tag where 11"},
      {"truncated spatial edge", "EDGE_SE3:QUAT 0 1 1 0 0 0 0 0 1 1\n",
       "file:1: 10 fields after the tag where 30"},
      {"negative id", "VERTEX_SE2 -1 0 0 0\n", "file:1: '-1' is not an integer"},
      {"fractional id", "VERTEX_SE2 1.5 0 0 0\n", "file:1: '1.5' is not an integer"},
      {"id beyond int64", "VERTEX_SE2 9223372036854775808 0 0 0\n",
       "file:1: '9223372036854775808' is"},
      {"vertex given twice", vertex + "\n" + vertex, "file:3: vertex 0 is given twice"},
      {"edge to itself", "EDGE_SE2 3 3 1 0 0  1 0 0 1 0 1\n",
       "file:1: an edge from vertex 3 to itself"},
      {"planar and spatial", vertex + "VERTEX_SE2 1 0 0 0\n", "file:2: planar and spatial"},
      {"spatial and planar", planar_edge + vertex, "file:2: planar and spatial"},
      {"NaN position", "VERTEX_SE2 0 nan 0 0\n", "file:1: 'nan' is not a finite number"},
      {"infinite heading", "VERTEX_SE2 0 0 0 inf\n", "file:1: 'inf' is not a finite number"},
      {"huge position", "VERTEX_SE2 0 1e8 0 0\n", "file:1: position"},
      {"zero quaternion", "VERTEX_SE3:QUAT 0 0 0 0 0 0 0 0\n", "file:1: quaternion has length 0"},
      {"bad quaternion", SpatialEdge("0 1 0 0 0 0.5 0 0 1"), "file:1: quaternion has length"},
      {"NaN information", "EDGE_SE2 0 1 1 0 0  1 0 0 nan 0 1\n",
       "file:1: 'nan' is not a finite number"},
      {"zero information", "EDGE_SE2 0 1 1 0 0  0 0 0 0 0 0\n",
       "file:1: the information matrix is not"},
      {"negative information", "EDGE_SE2 0 1 1 0 0  1 0 0 -1 0 1\n",
       "file:1: the information matrix is not"},
      {"indefinite information", "EDGE_SE2 0 1 1 0 0  1 2 0 1 0 1\n",
       "file:1: the information matrix is not"},
      {"overflowing information", "EDGE_SE2 0 1 1 0 0  1 1e300 0 1 0 1\n",
       "file:1: the information matrix is not"},
      {"an overflowing factor", "EDGE_SE2 0 1 1 0 0  1e-10 0 1e306 1 0 1\n",
       "file:1: the information matrix is not"},
      {"a gap in the ids", planar_edge + "EDGE_SE2 3 4 1 0 0  1 0 0 1 0 1\n",
       "file: vertex 3 has neither a pose nor an edge from 2"},
      {"no newline at all", std::string(100000, '7'), "file:1: longer than 4096 characters"},
  };
  for (const auto& [why, text, message] : cases) {
    const absl::Status status = Parse(text).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << why;
    EXPECT_EQ(status.message().find(message), 0u) << why << ": " << status;
  }
}

TEST(ReadG2o, SaysWhenThereIsNoSuchFile) {
  EXPECT_EQ(ReadG2o("/nonexistent").status().code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(ReadG2o("/").status().code(), absl::StatusCode::kDataLoss);
}

TEST(G2oReadOptions, DefaultsAreValidAndNonsenseIsRefused) {
  EXPECT_TRUE(G2oReadOptions().Validate().ok());
  for (const double bad : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_FALSE(Parse("VERTEX_SE2 0 0 0 0\n", {bad, 1}).ok());
    EXPECT_FALSE(Parse("VERTEX_SE2 0 0 0 0\n", {1, bad}).ok());
  }
}

void ExpectSameGraph(const PoseGraph& a, const PoseGraph& b) {
  ASSERT_EQ(a.poses.size(), b.poses.size());
  ASSERT_EQ(a.edges.size(), b.edges.size());
  const auto difference = [](const Rigid3d& x, const Rigid3d& y) {
    return (x.ToMatrix() - y.ToMatrix()).cwiseAbs().maxCoeff();
  };
  for (size_t i = 0; i < a.poses.size(); ++i) EXPECT_LT(difference(a.poses[i], b.poses[i]), 1e-15);
  for (size_t i = 0; i < a.edges.size(); ++i) {
    EXPECT_EQ(a.edges[i].from, b.edges[i].from);
    EXPECT_EQ(a.edges[i].to, b.edges[i].to);
    EXPECT_EQ(a.edges[i].kind, b.edges[i].kind);
    EXPECT_EQ(a.edges[i].information, b.edges[i].information);
    EXPECT_LT(difference(a.edges[i].from_tform_to, b.edges[i].from_tform_to), 1e-15);
  }
}

TEST(WriteG2o, SpatialFilesReadBack) {
  const auto written =
      Parse("VERTEX_SE3:QUAT 3 0.1 0.2 0.3 0 0.6 0 0.8\n" + SpatialEdge("3 4 1 2 3 0 0 0.6 0.8"));
  ASSERT_TRUE(written.ok()) << written.status();
  std::stringstream text;
  WriteG2o(text, *written);
  const auto read = ReadG2o(text, "file");
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_FALSE(read->planar);
  EXPECT_EQ(read->vertex_ids, written->vertex_ids);
  ExpectSameGraph(read->graph, written->graph);
}

TEST(WriteG2o, PlanarFilesReadBackAsPlanar) {
  const auto written = Parse(
      "VERTEX_SE2 5 1 2 -3.1\n"
      "EDGE_SE2 5 6 0.9 -0.1 0.3  10 1 2 20 3 30\n");
  ASSERT_TRUE(written.ok()) << written.status();
  std::stringstream text;
  WriteG2o(text, *written);
  EXPECT_EQ(text.str().find("VERTEX_SE2 5 1 2 -3.1"), 0u) << text.str();
  const auto read = ReadG2o(text, "file");
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_TRUE(read->planar);
  EXPECT_EQ(read->vertex_ids, written->vertex_ids);
  ExpectSameGraph(read->graph, written->graph);
}

TEST(WriteG2o, NumbersTheVerticesOfABareGraphFromZero) {
  const auto source =
      Parse("VERTEX_SE3:QUAT 3 0 0 0 0 0 0 1\n" + SpatialEdge("3 4 1 2 3 0 0 0.6 0.8"));
  ASSERT_TRUE(source.ok()) << source.status();
  const std::string path = testing::TempDir() + "/g2o_io_bare_graph";
  ASSERT_TRUE(WriteG2o(path, source->graph).ok());
  const auto read = ReadG2o(path);
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_THAT(read->vertex_ids, ElementsAre(0, 1));
  ExpectSameGraph(read->graph, source->graph);
  std::filesystem::remove(path);
}

TEST(WriteG2o, SaysWhenItCannotWrite) {
  EXPECT_EQ(WriteG2o("/nonexistent/file", PoseGraph()).code(), absl::StatusCode::kUnavailable);
}

}  // namespace
}  // namespace overtone
