// SPDX-License-Identifier: Apache-2.0
// The orthonormal vectors that Lanczos runs through, kept.
#ifndef OVERTONE_CORE_SPECTRAL_KRYLOV_BASIS_H_
#define OVERTONE_CORE_SPECTRAL_KRYLOV_BASIS_H_

#include <algorithm>
#include <vector>

#include "Eigen/Core"

namespace overtone {

// The basis V of each signal, in blocks of columns: growing copies nothing.
template <typename Scalar>
class KrylovBases {
 public:
  using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;

  explicit KrylovBases(int num_signals) : blocks_(num_signals) {}

  // Column c of `vectors` becomes the next vector of signal c's basis; further columns are ignored.
  template <typename Vectors>
  void Append(const Eigen::MatrixBase<Vectors>& vectors) {
    const int column = size_++ % kBlock;
    for (size_t c = 0; c < blocks_.size(); ++c) {
      if (column == 0) blocks_[c].emplace_back(vectors.rows(), kBlock);
      blocks_[c].back().col(column) = vectors.col(c).template cast<Scalar>();
    }
  }

  // The first m vectors of the signal's basis times `weights`, m x k.
  Eigen::MatrixXd Combine(int signal, const Eigen::MatrixXd& weights) const {
    const Matrix rounded = weights.cast<Scalar>();
    Matrix sum = Matrix::Zero(blocks_[signal][0].rows(), weights.cols());
    const int m = static_cast<int>(weights.rows());
    for (int first = 0; first < m; first += kBlock) {
      const int count = std::min(kBlock, m - first);
      sum.noalias() +=
          blocks_[signal][first / kBlock].leftCols(count) * rounded.middleRows(first, count);
    }
    return sum.template cast<double>();
  }

 private:
  static constexpr int kBlock = 32;
  int size_ = 0;
  std::vector<std::vector<Matrix>> blocks_;
};

}  // namespace overtone

#endif  // OVERTONE_CORE_SPECTRAL_KRYLOV_BASIS_H_
