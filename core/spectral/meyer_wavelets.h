// SPDX-License-Identifier: Apache-2.0
// The Meyer filter bank: one scaling kernel and S - 1 wavelet kernels that split the graph
// frequencies [0, lmax] into octaves, the lowest first. A tight frame: sum_s g_s(lambda)^2 = 1
// there. Leonardi & Van De Ville, IEEE TSP 61(13), 2013, with the auxiliary function v(x) = x^4 (35
// - 84 x + 70 x^2 - 20 x^3).
#ifndef OVERTONE_CORE_SPECTRAL_MEYER_WAVELETS_H_
#define OVERTONE_CORE_SPECTRAL_MEYER_WAVELETS_H_

#include "Eigen/Core"

namespace overtone {

class MeyerFilterBank {
 public:
  // lmax >= 0: the largest graph frequency; 0 (no edges) leaves the scaling kernel alone: g_0 = 1,
  // all others 0. num_scales >= 2.
  MeyerFilterBank(double lmax, int num_scales);

  int num_scales() const { return num_scales_; }
  double lmax() const { return lmax_; }

  // g_s(lambda), s = 0 the scaling kernel (lowest frequencies), s = num_scales - 1 the highest.
  double Evaluate(int scale, double lambda) const;

  // num_scales x m: Evaluate(s, lambdas[j]) at (s, j).
  Eigen::MatrixXd Evaluate(const Eigen::VectorXd& lambdas) const;

 private:
  double lmax_;
  int num_scales_;
  Eigen::VectorXd dilations_;  // 4 / (3 lmax) 2^(S - 2 - k), k = 0..S-2
};

}  // namespace overtone

#endif  // OVERTONE_CORE_SPECTRAL_MEYER_WAVELETS_H_
