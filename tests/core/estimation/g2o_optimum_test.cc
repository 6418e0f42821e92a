// SPDX-License-Identifier: Apache-2.0
// The known optima of public pose-graph benchmarks, from the file's guess and from odometry and
// chordal relaxation.
#include <cstdio>
#include <filesystem>
#include <string>

#include "gtest/gtest.h"
#include "overtone/core/estimation/pose_graph_optimizer.h"
#include "overtone/core/graph/g2o_io.h"

namespace overtone {
namespace {

struct Benchmark {
  std::string name;
  double optimum;  // sum |Log(Z^-1 T_i^-1 T_j)|^2_Omega
};

class G2oOptimumTest : public ::testing::TestWithParam<Benchmark> {};

TEST_P(G2oOptimumTest, IsReachedToNineDigitsFromEveryInitialGuess) {
  const std::string path =
      std::string(OVERTONE_SOURCE_DIR) + "/../shared/data/g2o/" + GetParam().name + ".g2o";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << path;
  const auto file = ReadG2o(path);
  ASSERT_TRUE(file.ok()) << file.status();
  const char* names[] = {"given", "odometry", "chordal"};
  for (const auto initialisation :
       {PoseGraphInitialisation::kGiven, PoseGraphInitialisation::kSpanningTree,
        PoseGraphInitialisation::kChordal}) {
    PoseGraphOptimizerOptions options;
    options.initialisation = initialisation;
    const auto result = OptimizePoseGraph(file->graph, options);
    ASSERT_TRUE(result.ok()) << result.status();
    const double cost = 2 * result->final_cost;
    std::printf(
        "%-15s from %-8s %5zu poses %5zu edges  2 x cost %.12g  %2d iterations  %.3f s, of it %.3f "
        "s initialisation\n",
        GetParam().name.c_str(), names[static_cast<int>(initialisation)], file->graph.poses.size(),
        file->graph.edges.size(), cost, result->iterations, result->seconds,
        result->initialisation_s);
    EXPECT_TRUE(result->converged);
    // The optima are given to ten digits.
    EXPECT_NEAR(cost, GetParam().optimum, 1e-9 * GetParam().optimum);
  }
}

// The first three: two independent solvers agree to ten digits. intel: our three initialisations
// do.
INSTANTIATE_TEST_SUITE_P(Public, G2oOptimumTest,
                         ::testing::Values(Benchmark{"smallGrid3D", 1035.850665},
                                           Benchmark{"parking-garage", 1.268384799},
                                           Benchmark{"sphere2500", 1351.401926},
                                           Benchmark{"intel", 45.00423309}),
                         [](const auto& info) {
                           std::string name = info.param.name;
                           for (char& c : name) c = c == '-' ? '_' : c;
                           return name;
                         });

}  // namespace
}  // namespace overtone
