// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/synchronization/small_motion.h"

#include <random>

#include "gtest/gtest.h"

namespace overtone {
namespace {

// On both sides of 0.2 rad, where the series end, and at nothing at all.
TEST(SmallMotion, IsExpAndItsRightJacobianAtEverySize) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (const double angle : {0.0, 1e-8, 1e-3, 0.1, 0.19999, 0.20001, 0.5, 1.5, 3.0}) {
    Vector6d xi = Vector6d::NullaryExpr([&] { return normal(random); });
    xi.tail<3>() *= angle / xi.tail<3>().norm();
    const SmallMotion motion(xi);
    const Rigid3d expected = Exp(xi);
    EXPECT_LT((motion.rotation - expected.rotation.toRotationMatrix()).norm(), 1e-14) << angle;
    EXPECT_LT((motion.translation - expected.translation).norm(), 1e-14) << angle;
    Matrix6d jacobian = Matrix6d::Zero();
    jacobian << motion.right_jacobian.x, motion.right_jacobian.y, Eigen::Matrix3d::Zero(),
        motion.right_jacobian.x;
    EXPECT_LT((jacobian * InverseRightJacobian(xi) - Matrix6d::Identity()).norm(), 1e-11) << angle;
  }
}

// On both sides of 0.2 rad, where the series end.
TEST(MovedBy, IsExpAppliedToAPoint) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (const double angle : {0.0, 1e-8, 1e-3, 0.1, 0.19999, 0.20001, 0.5, 1.5, 3.0, 4.0}) {
    Vector6d xi = Vector6d::NullaryExpr([&] { return normal(random); });
    xi.tail<3>() *= angle / xi.tail<3>().norm();
    const Eigen::Vector3d point(100, -20, 3);
    EXPECT_LT((MovedBy(xi, point) - Exp(xi) * point).norm(), 1e-12) << angle;
  }
}

TEST(CongruenceSum, IsThatOfTheFullMatrices) {
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  CongruenceSum sum;
  Matrix6d expected = Matrix6d::Zero();
  for (int k = 0; k < 3; ++k) {
    const Matrix6d root = Matrix6d::NullaryExpr([&] { return normal(random); });
    const Matrix6d covariance = root * root.transpose();
    const Rigid3d transform = Exp(Vector6d::NullaryExpr([&] { return normal(random); }));
    const Matrix6d adjoint = Adjoint(transform);
    const TwistMatrix identity = {Eigen::Matrix3d::Identity(), Eigen::Matrix3d::Zero()};
    const TwistMatrix twist =
        AdjointTimes(transform.rotation.toRotationMatrix(), transform.translation, identity);
    sum.Add(twist, covariance);
    expected += adjoint * covariance * adjoint.transpose();
    const Vector6d v = Vector6d::NullaryExpr([&] { return normal(random); });
    EXPECT_LT((twist * v - adjoint * v).norm(), 1e-13);
    EXPECT_LT((twist.TransposeTimes(v) - adjoint.transpose() * v).norm(), 1e-13);
  }
  EXPECT_LT((sum.Sum() - expected).norm(), 1e-12 * expected.norm());
}

}  // namespace
}  // namespace overtone
