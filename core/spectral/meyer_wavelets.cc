// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/spectral/meyer_wavelets.h"

#include <cmath>

namespace overtone {
namespace {

// Quarter of a turn from x = 0 to 1, flat at both ends to third order.
double Angle(double x) {
  const double v = x * x * x * x * (35 + x * (-84 + x * (70 - 20 * x)));
  return 0.5 * M_PI * v;
}

double ScalingKernel(double x) {
  if (x < 2.0 / 3) return 1;
  if (x < 4.0 / 3) return std::cos(Angle(1.5 * x - 1));
  return 0;
}

double WaveletKernel(double x) {
  if (x < 2.0 / 3) return 0;
  if (x < 4.0 / 3) return std::sin(Angle(1.5 * x - 1));
  if (x < 8.0 / 3) return std::cos(Angle(0.75 * x - 1));
  return 0;
}

}  // namespace

MeyerFilterBank::MeyerFilterBank(double lmax, int num_scales)
    : lmax_(lmax), num_scales_(num_scales), dilations_(num_scales - 1) {
  for (int k = 0; k < num_scales - 1; ++k) {
    dilations_[k] = lmax > 0 ? std::ldexp(4 / (3 * lmax), num_scales - 2 - k) : 0;
  }
}

double MeyerFilterBank::Evaluate(int scale, double lambda) const {
  return scale == 0 ? ScalingKernel(dilations_[0] * lambda)
                    : WaveletKernel(dilations_[scale - 1] * lambda);
}

Eigen::MatrixXd MeyerFilterBank::Evaluate(const Eigen::VectorXd& lambdas) const {
  Eigen::MatrixXd kernels(num_scales_, lambdas.size());
  for (Eigen::Index j = 0; j < lambdas.size(); ++j) {
    for (int s = 0; s < num_scales_; ++s) kernels(s, j) = Evaluate(s, lambdas[j]);
  }
  return kernels;
}

}  // namespace overtone
