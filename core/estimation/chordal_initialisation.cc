// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/estimation/chordal_initialisation.h"

#include "Eigen/CholmodSupport"
#include "Eigen/SVD"
#include "Eigen/SparseCore"
#include "overtone/core/estimation/connected_components.h"

namespace overtone {
namespace {

constexpr int kHeld = -1;

// The normal equations H X = B of block-sparse linear least squares over the poses that are not
// held; pose i has `block` rows in X, which has 3 columns.
class NormalEquations {
 public:
  NormalEquations(const std::vector<int>& unknown_of_pose, int num_unknowns, int block)
      : unknown_of_pose_(unknown_of_pose),
        block_(block),
        size_(num_unknowns * block),
        rhs_(Eigen::MatrixXd::Zero(size_, 3)) {}

  // Adds weight * |x_to - a x_from - c|^2, a orthogonal. x_held: value of a held end (block x 3).
  void Add(const PoseGraphEdge& edge, double weight, const Eigen::MatrixXd& a,
           const Eigen::MatrixXd& c, const Eigen::MatrixXd& from_if_held,
           const Eigen::MatrixXd& to_if_held) {
    const int from = unknown_of_pose_[edge.from], to = unknown_of_pose_[edge.to];
    if (to != kHeld) {
      AddDiagonal(to, weight);
      rhs_.middleRows(to * block_, block_) += weight * c;
      if (from == kHeld) rhs_.middleRows(to * block_, block_) += weight * a * from_if_held;
    }
    if (from != kHeld) {
      AddDiagonal(from, weight);
      rhs_.middleRows(from * block_, block_) -= weight * a.transpose() * c;
      if (to == kHeld)
        rhs_.middleRows(from * block_, block_) += weight * a.transpose() * to_if_held;
    }
    if (from == kHeld || to == kHeld || from == to) return;
    for (int r = 0; r < block_; ++r) {
      for (int s = 0; s < block_; ++s) {
        const int row = to * block_ + r, column = from * block_ + s;
        // The lower triangle only.
        triplets_.emplace_back(std::max(row, column), std::min(row, column), -weight * a(r, s));
      }
    }
  }

  absl::StatusOr<Eigen::MatrixXd> Solve() const {
    if (size_ == 0) return rhs_;
    Eigen::SparseMatrix<double> matrix(size_, size_);
    matrix.setFromTriplets(triplets_.begin(), triplets_.end());
    Eigen::CholmodDecomposition<Eigen::SparseMatrix<double>, Eigen::Lower> solver;
    solver.cholmod().print = 0;
    solver.compute(matrix);
    if (solver.info() != Eigen::Success) {
      return absl::FailedPreconditionError(
          "chordal initialisation: the edges leave a pose undetermined");
    }
    return Eigen::MatrixXd(solver.solve(rhs_));
  }

 private:
  void AddDiagonal(int unknown, double weight) {
    for (int r = 0; r < block_; ++r) {
      triplets_.emplace_back(unknown * block_ + r, unknown * block_ + r, weight);
    }
  }

  const std::vector<int>& unknown_of_pose_;
  const int block_;
  const int size_;
  std::vector<Eigen::Triplet<double>> triplets_;
  Eigen::MatrixXd rhs_;
};

Eigen::Quaterniond NearestRotation(const Eigen::Matrix3d& matrix) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d u = svd.matrixU();
  if ((u * svd.matrixV().transpose()).determinant() < 0) u.col(2) *= -1;
  return Eigen::Quaterniond(u * svd.matrixV().transpose()).normalized();
}

// Unknowns are the transposed rotations: R_j^T = Z_R^T R_i^T.
absl::Status SolveRotations(const PoseGraph& graph, const std::vector<int>& unknown_of_pose,
                            int num_unknowns, std::vector<Rigid3d>& poses) {
  NormalEquations equations(unknown_of_pose, num_unknowns, /*block=*/3);
  for (const PoseGraphEdge& edge : graph.edges) {
    const double kappa = edge.information.bottomRightCorner<3, 3>().trace() / 3;
    equations.Add(edge, kappa, edge.from_tform_to.rotation.toRotationMatrix().transpose(),
                  Eigen::Matrix3d::Zero(), poses[edge.from].rotation.toRotationMatrix().transpose(),
                  poses[edge.to].rotation.toRotationMatrix().transpose());
  }
  const auto solution = equations.Solve();
  if (!solution.ok()) return solution.status();
  for (size_t i = 0; i < poses.size(); ++i) {
    if (unknown_of_pose[i] == kHeld) continue;
    poses[i].rotation =
        NearestRotation(solution->block<3, 3>(3 * unknown_of_pose[i], 0).transpose());
  }
  return absl::OkStatus();
}

absl::Status SolveTranslations(const PoseGraph& graph, const std::vector<int>& unknown_of_pose,
                               int num_unknowns, std::vector<Rigid3d>& poses) {
  NormalEquations equations(unknown_of_pose, num_unknowns, /*block=*/1);
  const Eigen::MatrixXd one = Eigen::MatrixXd::Ones(1, 1);
  for (const PoseGraphEdge& edge : graph.edges) {
    const double tau = edge.information.topLeftCorner<3, 3>().trace() / 3;
    const Eigen::Vector3d step = poses[edge.from].rotation * edge.from_tform_to.translation;
    equations.Add(edge, tau, one, step.transpose(), poses[edge.from].translation.transpose(),
                  poses[edge.to].translation.transpose());
  }
  const auto solution = equations.Solve();
  if (!solution.ok()) return solution.status();
  for (size_t i = 0; i < poses.size(); ++i) {
    if (unknown_of_pose[i] != kHeld) {
      poses[i].translation = solution->row(unknown_of_pose[i]).transpose();
    }
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::vector<Rigid3d>> ChordalInitialisation(const PoseGraph& graph) {
  const int num_poses = static_cast<int>(graph.poses.size());
  ConnectedComponents components(num_poses);
  for (const PoseGraphEdge& edge : graph.edges) components.Unite(edge.from, edge.to);
  std::vector<int> unknown_of_pose(num_poses, kHeld);
  int num_unknowns = 0;
  for (int i = 0; i < num_poses; ++i) {
    if (components.Representative(i) != i) unknown_of_pose[i] = num_unknowns++;
  }
  std::vector<Rigid3d> poses = graph.poses;
  absl::Status status = SolveRotations(graph, unknown_of_pose, num_unknowns, poses);
  if (status.ok()) status = SolveTranslations(graph, unknown_of_pose, num_unknowns, poses);
  if (!status.ok()) return status;
  return poses;
}

}  // namespace overtone
