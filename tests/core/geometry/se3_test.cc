// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/geometry/se3.h"

#include <cmath>

#include "gtest/gtest.h"
#include "overtone/tests/core/geometry/random_poses.h"

namespace overtone {
namespace {

constexpr double kPi = 3.14159265358979323846;
// From nothing through both sides of the switch to Taylor series (|phi| = 0.5; half angles: 1) to
// almost pi.
constexpr double kAngles[] = {0,         1e-300,     1e-12,      1e-8,      1e-4,
                              0.4999999, 0.5000001,  0.9999999,  1.0000001, 1.5,
                              2.5,       kPi - 1e-3, kPi - 1e-6, kPi - 1e-9};

double Difference(const Rigid3d& a, const Rigid3d& b) {
  return (a.ToMatrix() - b.ToMatrix()).cwiseAbs().maxCoeff();
}

Eigen::Matrix4d Wedge(const Vector6d& xi) {
  Eigen::Matrix4d wedge = Eigen::Matrix4d::Zero();
  wedge.topLeftCorner<3, 3>() = Skew(xi.tail<3>());
  wedge.topRightCorner<3, 1>() = xi.head<3>();
  return wedge;
}

// exp(Xi) by its power series: the definition that Exp must meet, in a form that shares no code
// with it.
Eigen::Matrix4d PowerSeries(const Eigen::Matrix4d& wedge) {
  Eigen::Matrix4d sum = Eigen::Matrix4d::Identity(), term = sum;
  for (int k = 1; k <= 60; ++k) {
    term = term * wedge / k;
    sum += term;
  }
  return sum;
}

TEST(Rigid3d, TakesPointsFromTheRightFrameToTheLeftOne) {
  // b sits at (1, 2, 3) of a, turned by 90 degrees about z: its x axis is a's y axis.
  const Rigid3d a_from_b(Eigen::Quaterniond(std::sqrt(0.5), 0, 0, std::sqrt(0.5)), {1, 2, 3});
  EXPECT_LT((a_from_b * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(1, 3, 3)).norm(), 1e-15);
  EXPECT_LT((a_from_b.Inverse() * Eigen::Vector3d(1, 3, 3) - Eigen::Vector3d(1, 0, 0)).norm(),
            1e-15);
}

TEST(Rigid3d, ProductAndInverseAreThoseOfTheMatrices) {
  RandomPoses random(1);
  for (int i = 0; i < 100; ++i) {
    const Rigid3d a = random.Pose(10), b = random.Pose(10);
    EXPECT_LT(((a * b).ToMatrix() - a.ToMatrix() * b.ToMatrix()).norm(), 1e-13);
    EXPECT_LT((a.Inverse().ToMatrix() - a.ToMatrix().inverse()).norm(), 1e-13);
  }
}

TEST(Rigid3d, AMillionProductsKeepTheQuaternionAtUnitLength) {
  RandomPoses random(2);
  const Rigid3d step = random.Pose(0.1);
  Rigid3d product;
  for (int i = 0; i < 1000000; ++i) product = product * step;
  EXPECT_NEAR(product.rotation.norm(), 1, 1e-15);
}

TEST(Exp, IsThePowerSeriesOfTheWedge) {
  RandomPoses random(3);
  for (const double angle : kAngles) {
    const Vector6d xi = random.Tangent(3, angle);
    EXPECT_LT((Exp(xi).ToMatrix() - PowerSeries(Wedge(xi))).cwiseAbs().maxCoeff(), 1e-13) << angle;
  }
}

TEST(Log, UndoesExpFromIdentityToAlmostPi) {
  RandomPoses random(4);
  for (const double angle : kAngles) {
    for (int i = 0; i < 20; ++i) {
      const Vector6d xi = random.Tangent(3, angle);
      EXPECT_LT((Log(Exp(xi)) - xi).norm(), 2e-14 * (1 + xi.norm())) << "|phi| = " << angle;
    }
  }
}

TEST(Log, KeepsFullRelativePrecisionOfTinyMotions) {
  RandomPoses random(5);
  for (const double size : {1e-8, 1e-100}) {
    const Vector6d xi = random.Tangent(size, size);
    EXPECT_LT((Log(Exp(xi)) - xi).norm(), 1e-15 * xi.norm()) << size;
  }
}

TEST(Log, OfAHalfTurnIsFiniteAndComesBack) {
  for (const Eigen::Vector3d& axis : {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 0.6, -0.8)}) {
    const Rigid3d half_turn(Eigen::Quaterniond(0, axis.x(), axis.y(), axis.z()), {1, 2, 3});
    const Vector6d xi = Log(half_turn);
    ASSERT_TRUE(xi.allFinite());
    EXPECT_NEAR(xi.tail<3>().norm(), kPi, 1e-15);
    EXPECT_LT(Difference(Exp(xi), half_turn), 1e-14);
  }
}

TEST(LogSO3, TakesTheShortestWayForEitherSignOfTheQuaternion) {
  const Eigen::Quaterniond rotation = ExpSO3({0.1, -0.2, 3.0});
  const Eigen::Quaterniond negated(Eigen::Vector4d(-rotation.coeffs()));
  EXPECT_LT((LogSO3(rotation) - LogSO3(negated)).norm(), 1e-15);
  EXPECT_LE(LogSO3(ExpSO3({0, 0, 4})).norm(), kPi);
  EXPECT_NEAR(LogSO3(ExpSO3({0, 0, 4})).z(), 4 - 2 * kPi, 1e-15);
}

TEST(Adjoint, MovesATangentFromRightToLeft) {
  RandomPoses random(6);
  for (const double angle : {1e-8, 0.3, 2.0}) {
    const Rigid3d pose = random.Pose(5);
    const Vector6d xi = random.Tangent(1, angle);
    EXPECT_LT(Difference(pose * Exp(xi) * pose.Inverse(), Exp(Adjoint(pose) * xi)), 1e-13);
  }
}

TEST(InverseJacobians, AgreeWithCentralDifferences) {
  RandomPoses random(7);
  constexpr double kStep = 1e-5;
  // Below pi, where Log is smooth.
  for (const double angle : {0.0, 1e-8, 1e-4, 0.4999, 0.5001, 0.9999, 1.0001, 2.0, 3.0}) {
    const Vector6d xi = random.Tangent(2, angle);
    Matrix6d right, left;
    for (int k = 0; k < 6; ++k) {
      const Vector6d step = kStep * Vector6d::Unit(k);
      right.col(k) = (Log(Exp(xi) * Exp(step)) - Log(Exp(xi) * Exp(-step))) / (2 * kStep);
      left.col(k) = (Log(Exp(step) * Exp(xi)) - Log(Exp(-step) * Exp(xi))) / (2 * kStep);
    }
    // Truncation grows towards pi with the third derivative of Log.
    const double tolerance = angle < 2.5 ? 1e-8 : 1e-6;
    EXPECT_LT((InverseRightJacobian(xi) - right).cwiseAbs().maxCoeff(), tolerance) << angle;
    EXPECT_LT((InverseLeftJacobian(xi) - left).cwiseAbs().maxCoeff(), tolerance) << angle;
  }
}

// Ad(Exp(xi)) = J_l J_r^-1, and both J are smooth through the switch between series and closed
// form.
TEST(InverseJacobians, AreTiedByTheAdjoint) {
  RandomPoses random(8);
  for (const double angle : kAngles) {
    const Vector6d xi = random.Tangent(2, angle);
    const Matrix6d expected = InverseLeftJacobian(xi) * Adjoint(Exp(xi));
    EXPECT_LT((InverseRightJacobian(xi) - expected).cwiseAbs().maxCoeff(), 1e-12) << angle;
  }
}

}  // namespace
}  // namespace overtone
