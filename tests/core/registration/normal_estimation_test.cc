// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/registration/normal_estimation.h"

#include "Eigen/Geometry"
#include "gtest/gtest.h"
#include "overtone/core/simulation/random.h"

namespace overtone {
namespace {

using Eigen::Vector3f;

TEST(NormalEstimation, IsThePlanesNormalAndCertain) {
  const Vector3f normal = Vector3f(1, 2, -2) / 3;
  const Vector3f a = normal.unitOrthogonal(), b = normal.cross(a);
  Random random(1);
  std::vector<Vector3f> points;
  for (int i = 0; i < 200; ++i) {
    points.push_back(Vector3f(50, 60, 7) + 3 * random.Uniform() * a + 3 * random.Uniform() * b);
  }
  const KdTree tree(points);
  for (const SurfaceNormal& estimate : EstimateNormals(points, tree, 10, SurfaceKind::kSurface)) {
    EXPECT_NEAR(std::abs(estimate.direction.dot(normal)), 1, 1e-4);
    EXPECT_GT(estimate.certainty, 0.99);
  }
}

TEST(NormalEstimation, IsUncertainOnALineInSpace) {
  Random random(2);
  std::vector<Vector3f> points;
  double sum = 0;
  for (int i = 0; i < 100; ++i) {
    points.push_back(Vector3f(0.1f * i, 0, 0) + 0.01f * random.Normal3().cast<float>());
  }
  const KdTree tree(points);
  for (const SurfaceNormal& estimate : EstimateNormals(points, tree, 10, SurfaceKind::kSurface)) {
    EXPECT_NEAR(estimate.direction.x(), 0, 0.2);
    sum += estimate.certainty;
  }
  EXPECT_LT(sum / points.size(), 0.8);
}

TEST(NormalEstimation, OfAnOutlineLiesInTheLevelAcrossTheLine) {
  std::vector<Vector3f> points;
  for (int i = 0; i < 50; ++i) points.push_back(Vector3f(0.6f * i, 0.8f * i, 0));
  const KdTree tree(points);
  for (const SurfaceNormal& estimate : EstimateNormals(points, tree, 5, SurfaceKind::kOutline)) {
    EXPECT_NEAR(std::abs(estimate.direction.dot(Vector3f(0.8f, -0.6f, 0))), 1, 1e-5);
    EXPECT_EQ(estimate.direction.z(), 0);
  }
}

TEST(NormalEstimation, OfIdenticalPointsIsAUnitVectorThatIsWorthNothing) {
  const std::vector<Vector3f> points(10, Vector3f(1, 2, 0));
  const KdTree tree(points);
  for (const SurfaceKind kind : {SurfaceKind::kSurface, SurfaceKind::kOutline}) {
    for (const SurfaceNormal& estimate : EstimateNormals(points, tree, 5, kind)) {
      EXPECT_NEAR(estimate.direction.norm(), 1, 1e-6);
      EXPECT_EQ(estimate.certainty, 0);
    }
  }
}

}  // namespace
}  // namespace overtone
