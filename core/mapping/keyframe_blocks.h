// SPDX-License-Identifier: Apache-2.0
// The keyframes of a mission as uploaded, a submap's in one block. They never change, so every
// snapshot shares the blocks with the map and with the other snapshots.
#ifndef OVERTONE_CORE_MAPPING_KEYFRAME_BLOCKS_H_
#define OVERTONE_CORE_MAPPING_KEYFRAME_BLOCKS_H_

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <memory>
#include <utility>
#include <vector>

#include "overtone/core/graph/submap.h"

namespace overtone {

// Reads like a std::vector<Keyframe>; [] is a search among the blocks, an iterator walks.
class KeyframeBlocks {
 public:
  using value_type = Keyframe;

  class const_iterator {
   public:
    using iterator_category = std::random_access_iterator_tag;
    using value_type = Keyframe;
    using difference_type = std::ptrdiff_t;
    using pointer = const Keyframe*;
    using reference = const Keyframe&;

    const_iterator() = default;
    reference operator*() const { return blocks_->InBlock(block_, index_); }
    pointer operator->() const { return &**this; }
    reference operator[](difference_type n) const { return *(*this + n); }
    const_iterator& operator++() {
      if (++index_ >= blocks_->ends_[block_]) ++block_;
      return *this;
    }
    const_iterator& operator--() { return *this -= 1; }
    const_iterator& operator+=(difference_type n) {
      return *this = const_iterator(blocks_, index_ + static_cast<size_t>(n));
    }
    const_iterator& operator-=(difference_type n) { return *this += -n; }
    friend const_iterator operator+(const_iterator it, difference_type n) { return it += n; }
    friend const_iterator operator-(const_iterator it, difference_type n) { return it -= n; }
    friend difference_type operator-(const const_iterator& a, const const_iterator& b) {
      return static_cast<difference_type>(a.index_) - static_cast<difference_type>(b.index_);
    }
    friend bool operator==(const const_iterator& a, const const_iterator& b) {
      return a.index_ == b.index_;
    }
    friend bool operator!=(const const_iterator& a, const const_iterator& b) { return !(a == b); }
    friend bool operator<(const const_iterator& a, const const_iterator& b) {
      return a.index_ < b.index_;
    }

   private:
    friend class KeyframeBlocks;
    const_iterator(const KeyframeBlocks* blocks, size_t index)
        : blocks_(blocks), index_(index), block_(blocks->BlockOf(index)) {}

    const KeyframeBlocks* blocks_ = nullptr;
    size_t index_ = 0;
    size_t block_ = 0;
  };

  KeyframeBlocks() = default;
  KeyframeBlocks(std::vector<Keyframe> keyframes) { Append(std::move(keyframes)); }  // one block

  void Append(std::vector<Keyframe> keyframes) {
    if (keyframes.empty()) return;
    ends_.push_back(size() + keyframes.size());
    blocks_.push_back(std::make_shared<const std::vector<Keyframe>>(std::move(keyframes)));
  }

  size_t size() const { return ends_.empty() ? 0 : ends_.back(); }
  bool empty() const { return ends_.empty(); }
  const Keyframe& operator[](size_t i) const { return InBlock(BlockOf(i), i); }
  const Keyframe& front() const { return blocks_.front()->front(); }
  const Keyframe& back() const { return blocks_.back()->back(); }
  const_iterator begin() const { return const_iterator(this, 0); }
  const_iterator end() const { return const_iterator(this, size()); }

 private:
  size_t BlockOf(size_t i) const {
    return std::upper_bound(ends_.begin(), ends_.end(), i) - ends_.begin();
  }
  const Keyframe& InBlock(size_t block, size_t i) const {
    return (*blocks_[block])[i - (block == 0 ? 0 : ends_[block - 1])];
  }

  std::vector<std::shared_ptr<const std::vector<Keyframe>>> blocks_;
  std::vector<size_t> ends_;  // of each block, counted from the mission's first keyframe
};

}  // namespace overtone

#endif  // OVERTONE_CORE_MAPPING_KEYFRAME_BLOCKS_H_
