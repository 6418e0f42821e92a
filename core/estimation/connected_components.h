// SPDX-License-Identifier: Apache-2.0
// Which elements hang together, by union-find (Tarjan) with path halving.
#ifndef OVERTONE_CORE_ESTIMATION_CONNECTED_COMPONENTS_H_
#define OVERTONE_CORE_ESTIMATION_CONNECTED_COMPONENTS_H_

#include <numeric>
#include <vector>

namespace overtone {

class ConnectedComponents {
 public:
  explicit ConnectedComponents(int num_elements) : parent_(num_elements) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }

  // The smallest element of the component: it names it.
  int Representative(int element) {
    while (parent_[element] != element) {
      parent_[element] = parent_[parent_[element]];
      element = parent_[element];
    }
    return element;
  }

  void Unite(int a, int b) {
    a = Representative(a);
    b = Representative(b);
    if (a != b) parent_[a < b ? b : a] = a < b ? a : b;
  }

  // One for each component, increasing.
  std::vector<int> Representatives() {
    std::vector<int> representatives;
    for (int i = 0; i < static_cast<int>(parent_.size()); ++i) {
      if (Representative(i) == i) representatives.push_back(i);
    }
    return representatives;
  }

 private:
  std::vector<int> parent_;
};

}  // namespace overtone

#endif  // OVERTONE_CORE_ESTIMATION_CONNECTED_COMPONENTS_H_
