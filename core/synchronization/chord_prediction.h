// SPDX-License-Identifier: Apache-2.0
// What a chain of odometry becomes when chords between consecutive knots tie it to the server's
// estimate, before anybody applies them.
//
// Between two knots a, b the host's estimator finds the most likely motion given both ends: the gap
// at b, spread over the steps by their covariance. With A_i = server_i * odometry_i^-1, which takes
// the odometry's frame to the server's, the gap is e = Log(A_b A_a^-1), and seen from one fixed
// frame the steps' errors are a random walk of covariance P_i = sum_j Ad(server_j) Q_j
// Ad(server_j)^T. So node i moves by
//     Exp((P_i - P_a) (P_b - P_a)^-1 e) A_a,
// chords being far stiffer than odometry (knot_selection.h). Before the first knot and behind the
// last one the odometry stays as it is. Stretches do not influence each other.
#ifndef OVERTONE_CORE_SYNCHRONIZATION_CHORD_PREDICTION_H_
#define OVERTONE_CORE_SYNCHRONIZATION_CHORD_PREDICTION_H_

#include <vector>

#include "Eigen/Core"
#include "overtone/core/geometry/se3.h"

namespace overtone {

// Sums over the residuals r_i = predicted - server position of some nodes, in the server's frame.
struct ResidualSums {
  double squares = 0;                  // of |r_i|, m^2
  Vector6d moment = Vector6d::Zero();  // [r_i; p_i x r_i]: against which motions of the whole

  ResidualSums& operator+=(const ResidualSums& other);
  ResidualSums& operator-=(const ResidualSums& other);
};

class ChordPrediction {
 public:
  // All of the same length n >= 1. server: map_from_body. odometry: estimate_from_body, another
  // frame. step_covariance[i]: of the motion from node i - 1 to i, right tangent, positive
  // definite; [0] is not read.
  ChordPrediction(const std::vector<Rigid3d>& server, const std::vector<Rigid3d>& odometry,
                  const std::vector<Matrix6d>& step_covariance);

  int size() const { return static_cast<int>(server_.size()); }

  // Of the nodes between two knots, before the first and behind the last; knots lie on the server's
  // pose. At most `max_samples` nodes are looked at and stand for the others; 0: all.
  ResidualSums Between(int from, int to, int max_samples) const;
  ResidualSums Before(int knot, int max_samples) const;
  ResidualSums Behind(int knot, int max_samples) const;
  // Of all nodes. knots: rows, increasing, at least one.
  ResidualSums Of(const std::vector<int>& knots, int max_samples) const;

  // After the rigid motion that brings the prediction nearest to the server's positions, to first
  // order: J = [I, -p^x], H = sum J^T J, squares - moment^T H^-1 moment.
  double Rmse(const ResidualSums& sums) const;
  // That motion's tangent, H^-1 moment.
  Vector6d Alignment(const ResidualSums& sums) const { return alignment_ * sums.moment; }

  // The poses themselves, in the server's frame up to the shift of its origin.
  std::vector<Rigid3d> Predict(const std::vector<int>& knots) const;

  // RMSE of Predict's positions against the server's after rigid alignment, exactly; without knots
  // that of the odometry.
  double ExactRmse(const std::vector<int>& knots) const;

  // How unlikely the gap between two nodes is by odometry's covariance: chi-square of 6 degrees of
  // freedom.
  double GapChiSquare(int from, int to) const;

  // Of odometry from one node to a later one: right tangent of its relative pose.
  Matrix6d Covariance(int from, int to) const;

 private:
  template <typename Position>
  ResidualSums Sum(int begin, int end, int max_samples, const Position& position) const;
  Vector6d Gap(int from, int to) const;     // e
  Vector6d Spread(int from, int to) const;  // (P_b - P_a)^-1 e
  std::vector<Eigen::Vector3d> PredictPositions(const std::vector<int>& knots) const;

  std::vector<Rigid3d> server_;             // about the centroid, so that levers are short
  std::vector<Eigen::Vector3d> positions_;  // of these
  std::vector<Rigid3d> odometry_;
  std::vector<Rigid3d> server_from_odometry_;  // A
  std::vector<Matrix6d> walk_;                 // P
  Matrix6d alignment_;                         // H^-1
};

}  // namespace overtone

#endif  // OVERTONE_CORE_SYNCHRONIZATION_CHORD_PREDICTION_H_
