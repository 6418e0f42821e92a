// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/spectral/tridiagonal_eigensystem.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace overtone {
namespace {

constexpr int kMaxStepsPerEigenvalue = 30;

// The eigenvalue of the last 2 x 2 block that is nearer to its last entry.
double WilkinsonShift(double before_last, double last, double coupling) {
  const double half_gap = (before_last - last) / 2;
  return last -
         coupling * coupling / (half_gap + std::copysign(std::hypot(half_gap, coupling), half_gap));
}

}  // namespace

TridiagonalEigensystem::TridiagonalEigensystem(const std::vector<double>& diagonal,
                                               const std::vector<double>& subdiagonal)
    : eigenvalues_(Eigen::Map<const Eigen::VectorXd>(diagonal.data(), diagonal.size())) {
  const int m = static_cast<int>(diagonal.size());
  Eigen::VectorXd below = Eigen::Map<const Eigen::VectorXd>(subdiagonal.data(), m - 1);
  double norm = eigenvalues_.lpNorm<Eigen::Infinity>();
  if (m > 1) norm = std::max(norm, below.lpNorm<Eigen::Infinity>());
  const double negligible = std::numeric_limits<double>::epsilon() * norm;
  rotations_.reserve(static_cast<size_t>(m) * m);
  int steps_left = kMaxStepsPerEigenvalue * m;
  // Rows [begin, end] couple; those after `end` are done.
  for (int end = m - 1; end > 0;) {
    if (std::abs(below[end - 1]) <= negligible) {
      --end;
      continue;
    }
    int begin = end - 1;
    while (begin > 0 && std::abs(below[begin - 1]) > negligible) --begin;
    if (steps_left-- == 0) {
      ok_ = false;
      return;
    }
    QrStep(begin, end, below);
  }
}

// Chases the bulge below the subdiagonal, made by the first rotation, from `begin` to `end`.
void TridiagonalEigensystem::QrStep(int begin, int end, Eigen::VectorXd& below) {
  Eigen::VectorXd& d = eigenvalues_;
  double x = d[begin] - WilkinsonShift(d[end - 1], d[end], below[end - 1]);
  double bulge = below[begin];
  for (int k = begin; k < end; ++k) {
    const double length = std::sqrt(x * x + bulge * bulge);
    if (!(length > 0)) return;  // decoupled here
    const double c = x / length, s = -bulge / length;
    const double upper = d[k], coupling = below[k], lower = d[k + 1];
    d[k] = c * c * upper - 2 * c * s * coupling + s * s * lower;
    d[k + 1] = s * s * upper + 2 * c * s * coupling + c * c * lower;
    below[k] = c * s * (upper - lower) + (c * c - s * s) * coupling;
    if (k > begin) below[k - 1] = c * x - s * bulge;
    x = below[k];
    if (k + 1 < end) {
      bulge = -s * below[k + 1];
      below[k + 1] *= c;
    }
    rotations_.push_back({k, c, s});
  }
}

Eigen::MatrixXd TridiagonalEigensystem::FunctionsTimesFirstUnit(
    const Eigen::MatrixXd& values) const {
  Eigen::VectorXd first = Eigen::VectorXd::Unit(eigenvalues_.size(), 0);
  for (const auto& [k, c, s] : rotations_) {
    const double upper = first[k], lower = first[k + 1];
    first[k] = c * upper - s * lower;
    first[k + 1] = s * upper + c * lower;
  }
  // Row-major: a rotation combines two rows.
  const Eigen::Index num_functions = values.cols();
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> result =
      first.asDiagonal() * values;
  for (auto rotation = rotations_.rbegin(); rotation != rotations_.rend(); ++rotation) {
    const auto [k, c, s] = *rotation;
    double* const upper_row = result.data() + k * num_functions;
    double* const lower_row = upper_row + num_functions;
    for (Eigen::Index f = 0; f < num_functions; ++f) {
      const double upper = upper_row[f], lower = lower_row[f];
      upper_row[f] = c * upper + s * lower;
      lower_row[f] = c * lower - s * upper;
    }
  }
  return result;
}

double LargestTridiagonalEigenvalue(const std::vector<double>& diagonal,
                                    const std::vector<double>& subdiagonal) {
  const int m = static_cast<int>(diagonal.size());
  double norm = std::abs(diagonal[0]);
  for (int i = 0; i + 1 < m; ++i) {
    norm = std::max({norm, std::abs(diagonal[i + 1]), std::abs(subdiagonal[i])});
  }
  // All eigenvalues are below x when every pivot of x I - T is positive (Sylvester).
  const auto all_below = [&](double x) {
    double pivot = x - diagonal[0];
    for (int i = 0; i + 1 < m && pivot > 0; ++i) {
      pivot = x - diagonal[i + 1] - subdiagonal[i] * subdiagonal[i] / pivot;
    }
    return pivot > 0;
  };
  double low = *std::max_element(diagonal.begin(), diagonal.end()), high = 3 * norm;  // Gershgorin
  while (high - low > 1e-14 * norm) {
    const double middle = low + (high - low) / 2;
    if (!(low < middle && middle < high)) break;  // denormal or infinite entries
    (all_below(middle) ? high : low) = middle;
  }
  return low;
}

}  // namespace overtone
