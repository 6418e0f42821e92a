// SPDX-License-Identifier: Apache-2.0
// The estimator of docs/integrating.md, "Ceres", as it stands there.
#include "ceres_snippet.h"

#include <cmath>
#include <random>

#include "gtest/gtest.h"
#include "overtone/core/geometry/se3.h"

namespace overtone {
namespace {

Vector6d RandomTangent(std::mt19937& random, double size) {
  std::normal_distribution<double> normal(0, size);
  return Vector6d::NullaryExpr([&] { return normal(random); });
}

// r^T r = xi^T C^-1 xi: with L in place of L^T it is not, which a full covariance shows.
TEST(CeresSnippet, TheSquaredResidualIsTheMahalanobisDistance) {
  std::mt19937 random(7);
  for (const double size : {1e-9, 1e-3, 0.5}) {
    for (int i = 0; i < 20; ++i) {
      const Rigid3d from = Exp(RandomTangent(random, 1)), measured = Exp(RandomTangent(random, 1));
      const Vector6d xi = RandomTangent(random, size);
      const Rigid3d to = from * measured * Exp(xi);
      const Matrix6d root = Matrix6d::NullaryExpr([&] { return RandomTangent(random, 1)(0); });
      const Matrix6d covariance = root * root.transpose() + 0.1 * Matrix6d::Identity();
      Vector6d residual;
      ASSERT_TRUE(RelativePoseCost(measured, covariance)(
          from.translation.data(), from.rotation.coeffs().data(), to.translation.data(),
          to.rotation.coeffs().data(), residual.data()));
      const double expected = xi.dot(covariance.inverse() * xi);
      EXPECT_NEAR(residual.squaredNorm(), expected, 1e-6 * expected + 1e-16) << "size " << size;
    }
  }
}

class Circle {
 public:
  Circle() {
    for (int64_t i = 0; i <= kSteps; ++i) {
      estimator.AddKeyframe(Timestamp{i * 1'000'000'000}, Exp(step_), 1e-4 * Matrix6d::Identity());
    }
  }
  double Gap() {
    const std::vector<OnboardPose> poses = estimator.Trajectory();
    return (poses.back().estimate_from_body.translation -
            poses.front().estimate_from_body.translation)
        .norm();
  }
  Constraint Closing(const Rigid3d& from_tform_to) const {
    Constraint c;
    c.id = "chord:0-60";
    c.from = 0;
    c.to = kSteps;
    c.from_tform_to = from_tform_to;
    c.covariance = 1e-8 * Matrix6d::Identity();
    return c;
  }

  static constexpr int64_t kSteps = 60;
  CeresEstimator estimator;

 private:
  // 0.4 degrees too much to the left at every step.
  const Vector6d step_ = (Vector6d() << 1, 0, 0, 0, 0, 6.4 * M_PI / 180).finished();
};

TEST(CeresSnippet, AConstraintIsAddedReplacedAndTakenBack) {
  Circle circle;
  const double by_odometry = circle.Gap();
  ASSERT_GT(by_odometry, 3);

  ConstraintBatch batch;
  batch.add = {circle.Closing(Rigid3d())};
  for (int times = 0; times < 2; ++times) {  // offered again: no second one
    ASSERT_TRUE(circle.estimator.ApplyConstraints(batch).ok());
    EXPECT_LT(circle.Gap(), 0.01);
  }
  ConstraintBatch update;
  update.update = {circle.Closing(Rigid3d(Eigen::Quaterniond::Identity(), {0, 1, 0}))};
  ASSERT_TRUE(circle.estimator.ApplyConstraints(update).ok());
  EXPECT_NEAR(circle.Gap(), 1, 0.01);
  ConstraintBatch retract;
  retract.retract = {"chord:0-60", "chord:never-there"};
  ASSERT_TRUE(circle.estimator.ApplyConstraints(retract).ok());
  EXPECT_NEAR(circle.Gap(), by_odometry, 1e-4);
}

}  // namespace
}  // namespace overtone
