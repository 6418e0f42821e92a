// SPDX-License-Identifier: Apache-2.0
// [X, Y; 0, X], the shape of SE(3)'s adjoints and Jacobians: half the numbers of a 6 x 6 matrix,
// and a third of the work in products with one.
#ifndef OVERTONE_CORE_SYNCHRONIZATION_TWIST_MATRIX_H_
#define OVERTONE_CORE_SYNCHRONIZATION_TWIST_MATRIX_H_

#include "Eigen/Core"
#include "Eigen/Geometry"
#include "overtone/core/geometry/se3.h"

namespace overtone {

struct TwistMatrix {
  Eigen::Matrix3d x, y;

  Vector6d operator*(const Vector6d& v) const {
    Vector6d product;
    product.head<3>().noalias() = x * v.head<3>() + y * v.tail<3>();
    product.tail<3>().noalias() = x * v.tail<3>();
    return product;
  }

  // Transposed.
  Vector6d TransposeTimes(const Vector6d& v) const {
    Vector6d product;
    product.head<3>().noalias() = x.transpose() * v.head<3>();
    product.tail<3>().noalias() = y.transpose() * v.head<3>() + x.transpose() * v.tail<3>();
    return product;
  }
};

// Adjoint(transform) * matrix, the transform given as a rotation matrix and a translation.
inline TwistMatrix AdjointTimes(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation,
                                const TwistMatrix& matrix) {
  TwistMatrix product;
  product.x.noalias() = rotation * matrix.x;
  product.y.noalias() = rotation * matrix.y;
  for (int column = 0; column < 3; ++column) {
    product.y.col(column) += translation.cross(product.x.col(column));
  }
  return product;
}

// Sums of M C M^T for symmetric C.
class CongruenceSum {
 public:
  void Add(const TwistMatrix& m, const Matrix6d& c) {
    const auto c_xx = c.topLeftCorner<3, 3>(), c_xy = c.topRightCorner<3, 3>();
    const auto c_yy = c.bottomRightCorner<3, 3>();
    const Eigen::Matrix3d left = m.x * c_xx + m.y * c_xy.transpose();
    const Eigen::Matrix3d right = m.x * c_xy + m.y * c_yy;
    const Eigen::Matrix3d below = m.x * c_yy;
    top_left_.noalias() += left * m.x.transpose();
    top_left_.noalias() += right * m.y.transpose();
    top_right_.noalias() += right * m.x.transpose();
    bottom_right_.noalias() += below * m.x.transpose();
  }

  Matrix6d Sum() const {
    Matrix6d sum;
    sum << top_left_, top_right_, top_right_.transpose(), bottom_right_;
    return sum;
  }

 private:
  Eigen::Matrix3d top_left_ = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d top_right_ = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d bottom_right_ = Eigen::Matrix3d::Zero();
};

}  // namespace overtone

#endif  // OVERTONE_CORE_SYNCHRONIZATION_TWIST_MATRIX_H_
