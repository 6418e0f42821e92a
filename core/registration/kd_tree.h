// SPDX-License-Identifier: Apache-2.0
// Nearest neighbours in 3-D: a k-d tree over points (nanoflann).
#ifndef OVERTONE_CORE_REGISTRATION_KD_TREE_H_
#define OVERTONE_CORE_REGISTRATION_KD_TREE_H_

#include <memory>
#include <vector>

#include "Eigen/Core"
#include "absl/types/span.h"

namespace overtone {

// Immutable; any number of threads may search at once.
class KdTree {
 public:
  // `points`: finite. Kept by reference: they must outlive the tree, unmoved. O(n log n).
  explicit KdTree(const std::vector<Eigen::Vector3f>& points);
  ~KdTree();
  KdTree(const KdTree&) = delete;
  KdTree& operator=(const KdTree&) = delete;

  struct Neighbor {
    int index = -1;  // -1: none
    float squared_distance = 0;
  };
  // The nearest point closer than sqrt(max_squared_distance). The smaller that is, the faster.
  Neighbor Nearest(const Eigen::Vector3f& query, float max_squared_distance) const;

  // The nearest points, nearest first, into `indices`; how many there are: as many as it has room
  // for, or all.
  int Nearest(const Eigen::Vector3f& query, absl::Span<int> indices) const;

 private:
  struct Index;
  std::unique_ptr<const Index> index_;
};

}  // namespace overtone

#endif  // OVERTONE_CORE_REGISTRATION_KD_TREE_H_
