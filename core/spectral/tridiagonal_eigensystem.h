// SPDX-License-Identifier: Apache-2.0
// Functions of a symmetric tridiagonal matrix in O(m^2), where eigenvectors would take O(m^3).
#ifndef OVERTONE_CORE_SPECTRAL_TRIDIAGONAL_EIGENSYSTEM_H_
#define OVERTONE_CORE_SPECTRAL_TRIDIAGONAL_EIGENSYSTEM_H_

#include <vector>

#include "Eigen/Core"

namespace overtone {

// T = Q diag(eigenvalues) Q^T by implicit QR steps with Wilkinson's shift (Golub & Van Loan, Matrix
// Computations, 8.3). Q stays the product of its plane rotations, about m^2 of them: applying it to
// a few vectors is all that f(T) b = Q f(Lambda) Q^T b needs.
class TridiagonalEigensystem {
 public:
  // diagonal: m > 0 entries; subdiagonal: the m - 1 below it, further ones ignored; finite.
  TridiagonalEigensystem(const std::vector<double>& diagonal,
                         const std::vector<double>& subdiagonal);

  // False: no convergence in 30 steps per eigenvalue, which no finite T is known to need.
  bool ok() const { return ok_; }
  const Eigen::VectorXd& eigenvalues() const { return eigenvalues_; }  // in no order

  // f(T) e_1 for several f: column k is Q (values.col(k) o Q^T e_1). values: m x functions, the
  // functions at the eigenvalues.
  Eigen::MatrixXd FunctionsTimesFirstUnit(const Eigen::MatrixXd& values) const;

 private:
  struct Rotation {
    int k;  // of rows k and k + 1
    double cosine, sine;
  };

  void QrStep(int begin, int end, Eigen::VectorXd& subdiagonal);

  bool ok_ = true;
  Eigen::VectorXd eigenvalues_;
  std::vector<Rotation> rotations_;
};

// By bisection, to round-off of the largest entry; the same arguments. O(m).
double LargestTridiagonalEigenvalue(const std::vector<double>& diagonal,
                                    const std::vector<double>& subdiagonal);

}  // namespace overtone

#endif  // OVERTONE_CORE_SPECTRAL_TRIDIAGONAL_EIGENSYSTEM_H_
