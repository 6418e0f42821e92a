// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/spectral/lanczos.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "overtone/core/spectral/tridiagonal_eigensystem.h"

namespace overtone {
namespace {

// Symmetric: a stored column is a row, so each output is one dot product held in registers. Narrow
// ones as four sums, since the latency of an addition is longer than the rest of the loop.
template <int kColumns>
void MultiplyRows(const SparseMatrix& symmetric, const double* vectors, double* product) {
  constexpr int kSums = kColumns <= 2 ? 4 : 2;
  using Row = Eigen::Matrix<double, 1, kColumns>;
  const int* outer = symmetric.outerIndexPtr();
  const int* inner = symmetric.innerIndexPtr();
  const double* values = symmetric.valuePtr();
  const auto term = [&](int k) {
    return values[k] * Eigen::Map<const Row>(vectors + int64_t{inner[k]} * kColumns);
  };
  for (Eigen::Index row = 0; row < symmetric.cols(); ++row) {
    Row sums[kSums];
    for (Row& sum : sums) sum.setZero();
    int k = outer[row];
    for (; k + kSums <= outer[row + 1]; k += kSums) {
      for (int i = 0; i < kSums; ++i) sums[i] += term(k + i);
    }
    for (; k < outer[row + 1]; ++k) sums[0] += term(k);
    for (int i = 1; i < kSums; ++i) sums[0] += sums[i];
    Eigen::Map<Row>(product + row * kColumns) = sums[0];
  }
}

constexpr int kMaxSteps = 1000;

}  // namespace

void MultiplySymmetric(const SparseMatrix& symmetric, const RowMajorMatrix& vectors,
                       RowMajorMatrix& product) {
  using Kernel = void (*)(const SparseMatrix&, const double*, double*);
  static constexpr Kernel kKernels[] = {MultiplyRows<1>, MultiplyRows<2>, MultiplyRows<3>,
                                        MultiplyRows<4>, MultiplyRows<5>, MultiplyRows<6>,
                                        MultiplyRows<7>, MultiplyRows<8>};
  kKernels[vectors.cols() - 1](symmetric, vectors.data(), product.data());
}

LockstepLanczos::LockstepLanczos(const SparseMatrix& laplacian, const Eigen::MatrixXd& starts)
    : laplacian_(laplacian),
      previous_(RowMajorMatrix::Zero(starts.rows(), starts.cols())),
      vectors_(starts),
      product_(starts.rows(), starts.cols()),
      tridiagonals_(starts.cols()) {
  // Gershgorin: |L| <= 2 max degree.
  const double norm_bound = starts.rows() == 0 ? 0 : 2 * laplacian.diagonal().cwiseAbs().maxCoeff();
  breakdown_ = 1e-12 * norm_bound;
  for (Eigen::Index c = 0; c < starts.cols(); ++c) {
    LanczosTridiagonal& t = tridiagonals_[c];
    t.start_norm = starts.col(c).stableNorm();
    t.exhausted = !(t.start_norm > 0);
    if (!t.exhausted) vectors_.col(c) /= t.start_norm;
  }
}

bool LockstepLanczos::AllExhausted() const {
  return std::all_of(tridiagonals_.begin(), tridiagonals_.begin() + num_columns(),
                     [](const LanczosTridiagonal& t) { return t.exhausted; });
}

void LockstepLanczos::DropLastColumn() {
  const int kept = num_columns() - 1;
  for (RowMajorMatrix* matrix : {&previous_, &vectors_, &product_}) {
    matrix->conservativeResize(Eigen::NoChange, kept);
  }
}

void LockstepLanczos::Step() {
  MultiplySymmetric(laplacian_, vectors_, product_);
  for (int c = 0; c < num_columns(); ++c) {
    LanczosTridiagonal& t = tridiagonals_[c];
    if (t.exhausted) continue;
    const double alpha = vectors_.col(c).dot(product_.col(c));
    product_.col(c) -= alpha * vectors_.col(c);
    if (t.dimension() > 0) product_.col(c) -= t.subdiagonal.back() * previous_.col(c);
    const double beta = product_.col(c).norm();
    t.diagonal.push_back(alpha);
    t.subdiagonal.push_back(beta);
    t.exhausted = !(beta > breakdown_);
    if (t.exhausted) {
      product_.col(c).setZero();
    } else {
      product_.col(c) /= beta;
    }
  }
  // An exhausted column stays 0: its products are 0.
  previous_.swap(vectors_);
  vectors_.swap(product_);
}

Eigen::VectorXd LmaxStartVector(const SparseMatrix& laplacian) {
  Eigen::VectorXd start(laplacian.rows());
  uint64_t state = 1;
  for (double& entry : start) {
    state = state * 6364136223846793005u + 1442695040888963407u;  // Knuth's MMIX generator
    entry = std::ldexp(static_cast<double>(state >> 11), -53) - 0.5;
  }
  if (laplacian.nonZeros() == 0) return start;
  const Eigen::ArrayXd degree = laplacian.diagonal();
  return start.array() * (0.01 + (degree / degree.maxCoeff()).pow(64));
}

double LargestRitzValue(const LanczosTridiagonal& tridiagonal) {
  if (tridiagonal.dimension() == 0) return 0;
  return std::max(0.0, LargestTridiagonalEigenvalue(tridiagonal.diagonal, tridiagonal.subdiagonal));
}

double LargestEigenvalue(const SparseMatrix& laplacian) {
  const int n = static_cast<int>(laplacian.rows());
  if (n == 0) return 0;
  LockstepLanczos lanczos(laplacian, LmaxStartVector(laplacian));
  double before = 0;
  for (int step = 1, next_look = 20; step <= kMaxSteps && !lanczos.AllExhausted(); ++step) {
    lanczos.Step();
    if (step < next_look) continue;
    // Ritz values grow towards lmax, and stall where eigenvalues crowd below it: on radius graphs
    // up to ten times the last gain was still missing.
    const double now = LargestRitzValue(lanczos.tridiagonal(0));
    if (now - before <= 1e-7 * now) return now;
    before = now;
    next_look += std::max(10, step / 8);
  }
  return LargestRitzValue(lanczos.tridiagonal(0));
}

}  // namespace overtone
