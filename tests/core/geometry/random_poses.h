// SPDX-License-Identifier: Apache-2.0
// Seeded tangents and poses for the laws below.
#ifndef OVERTONE_TESTS_CORE_GEOMETRY_RANDOM_POSES_H_
#define OVERTONE_TESTS_CORE_GEOMETRY_RANDOM_POSES_H_

#include <random>
#include <vector>

#include "overtone/core/geometry/se3.h"

namespace overtone {

class RandomPoses {
 public:
  explicit RandomPoses(unsigned seed) : generator_(seed) {}

  Eigen::Vector3d Vector(double sigma) {
    std::normal_distribution<double> normal(0, sigma);
    const double x = normal(generator_), y = normal(generator_), z = normal(generator_);
    return Eigen::Vector3d(x, y, z);
  }

  // xi with |rho| about rho_m and |phi| = angle_rad exactly, in a random direction.
  Vector6d Tangent(double rho_m, double angle_rad) {
    Vector6d xi;
    xi << Vector(rho_m), angle_rad * Vector(1).normalized();
    return xi;
  }

  Rigid3d Pose(double sigma_m) {
    std::uniform_real_distribution<double> angle(0, 3.1);
    return Exp(Tangent(sigma_m, angle(generator_)));
  }

  // A walk of steps of about sigma_m and 0.3 rad.
  std::vector<Rigid3d> Walk(int length, double sigma_m) {
    std::vector<Rigid3d> walk(1);
    while (walk.size() < static_cast<size_t>(length)) {
      walk.push_back(walk.back() * Exp(Tangent(sigma_m, 0.3)));
    }
    return walk;
  }

 private:
  std::mt19937 generator_;
};

}  // namespace overtone

#endif  // OVERTONE_TESTS_CORE_GEOMETRY_RANDOM_POSES_H_
