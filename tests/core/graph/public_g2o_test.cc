// SPDX-License-Identifier: Apache-2.0
// The public pose graphs, read whole. The data is read from beside the project and never part of
// it.
#include <algorithm>
#include <filesystem>
#include <ostream>
#include <string>

#include "gtest/gtest.h"
#include "overtone/core/graph/g2o_io.h"

namespace overtone {
namespace {

constexpr char kData[] = OVERTONE_SOURCE_DIR "/../shared/data/";

struct Case {
  std::string name;
  std::string path;
  bool planar;
  int poses;
  int edges;
  int loop_closures;
};

void PrintTo(const Case& param, std::ostream* out) { *out << param.name; }

class PublicG2o : public testing::TestWithParam<Case> {};

// Sum of squared whitened residuals, as the known optima are counted.
double Cost(const PoseGraph& graph) {
  double cost = 0;
  for (const PoseGraphEdge& edge : graph.edges) {
    const Rigid3d predicted = graph.poses[edge.from].Inverse() * graph.poses[edge.to];
    const Vector6d residual = Log(edge.from_tform_to.Inverse() * predicted);
    cost += residual.dot(edge.information * residual);
  }
  return cost;
}

TEST_P(PublicG2o, IsReadWhole) {
  const Case& param = GetParam();
  if (!std::filesystem::exists(kData + param.path))
    GTEST_SKIP() << kData << param.path << " is not there";
  const auto file = ReadG2o(kData + param.path);
  ASSERT_TRUE(file.ok()) << file.status();
  const auto& edges = file->graph.edges;
  const auto closures = std::count_if(edges.begin(), edges.end(), [](const PoseGraphEdge& edge) {
    return edge.kind == EdgeKind::kLoopClosure;
  });
  EXPECT_EQ(file->planar, param.planar);
  EXPECT_EQ(file->graph.poses.size(), param.poses);
  EXPECT_EQ(edges.size(), param.edges);
  EXPECT_EQ(closures, param.loop_closures);
  std::printf("%s: %zu poses, %zu edges, %td loop closures, cost of the initial guess %.9g\n",
              param.name.c_str(), file->graph.poses.size(), edges.size(), closures,
              Cost(file->graph));
}

INSTANTIATE_TEST_SUITE_P(
    , PublicG2o,
    testing::Values(Case{"smallGrid3D", "g2o/smallGrid3D.g2o", false, 125, 297, 173},
                    Case{"parking_garage", "g2o/parking-garage.g2o", false, 1661, 6275, 4615},
                    Case{"sphere2500", "g2o/sphere2500.g2o", false, 2500, 4949, 2450},
                    Case{"intel", "g2o/intel.g2o", true, 1728, 2512, 785},
                    Case{"kitti_00", "kitti/stereo_g2o/kitti_00.g2o", true, 4541, 4676, 136},
                    Case{"kitti_05", "kitti/stereo_g2o/kitti_05.g2o", true, 2761, 2826, 66}),
    [](const testing::TestParamInfo<Case>& info) { return info.param.name; });

}  // namespace
}  // namespace overtone
