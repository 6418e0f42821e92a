// SPDX-License-Identifier: Apache-2.0
// A symmetric 6 x 6 matrix as its 21 different numbers, exactly: for what is kept of every
// keyframe.
#ifndef OVERTONE_CORE_GEOMETRY_PACKED_COVARIANCE_H_
#define OVERTONE_CORE_GEOMETRY_PACKED_COVARIANCE_H_

#include <array>

#include "overtone/core/geometry/se3.h"

namespace overtone {

class PackedCovariance {
 public:
  PackedCovariance() : PackedCovariance(Matrix6d::Identity()) {}
  // Of a matrix that is not quite symmetric: its lower triangle.
  explicit PackedCovariance(const Matrix6d& matrix) {
    auto value = values_.begin();
    for (int column = 0; column < 6; ++column) {
      for (int row = column; row < 6; ++row) *value++ = matrix(row, column);
    }
  }

  Matrix6d Unpacked() const {
    Matrix6d matrix;
    auto value = values_.begin();
    for (int column = 0; column < 6; ++column) {
      for (int row = column; row < 6; ++row) matrix(row, column) = matrix(column, row) = *value++;
    }
    return matrix;
  }

 private:
  std::array<double, 21> values_;
};

}  // namespace overtone

#endif  // OVERTONE_CORE_GEOMETRY_PACKED_COVARIANCE_H_
