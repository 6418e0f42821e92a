// SPDX-License-Identifier: Apache-2.0
// A set of small integers, one bit each: intersection and counting go 64 elements at a time.
#ifndef OVERTONE_CORE_ESTIMATION_BIT_SET_H_
#define OVERTONE_CORE_ESTIMATION_BIT_SET_H_

#include <cstddef>
#include <cstdint>
#include <vector>

namespace overtone {

// Of elements in [0, capacity). Sets that are combined have equal capacity.
class BitSet {
 public:
  explicit BitSet(int capacity = 0) : words_((capacity + 63) / 64, 0) {}

  void Grow(int capacity) { words_.resize((capacity + 63) / 64, 0); }
  void Insert(int element) { words_[element / 64] |= Bit(element); }
  void Erase(int element) { words_[element / 64] &= ~Bit(element); }
  bool Contains(int element) const { return (words_[element / 64] & Bit(element)) != 0; }

  int Size() const {
    int size = 0;
    for (const uint64_t word : words_) size += __builtin_popcountll(word);
    return size;
  }

  // The smallest element, -1 when empty.
  int First() const {
    for (size_t w = 0; w < words_.size(); ++w) {
      if (words_[w] != 0) return static_cast<int>(64 * w) + __builtin_ctzll(words_[w]);
    }
    return -1;
  }

  void Intersect(const BitSet& other) {
    for (size_t w = 0; w < words_.size(); ++w) words_[w] &= other.words_[w];
  }
  void Subtract(const BitSet& other) {
    for (size_t w = 0; w < words_.size(); ++w) words_[w] &= ~other.words_[w];
  }

  // Increasing.
  std::vector<int> Elements() const {
    std::vector<int> elements;
    for (size_t w = 0; w < words_.size(); ++w) {
      for (uint64_t rest = words_[w]; rest != 0; rest &= rest - 1) {
        elements.push_back(static_cast<int>(64 * w) + __builtin_ctzll(rest));
      }
    }
    return elements;
  }

 private:
  static uint64_t Bit(int element) { return uint64_t{1} << (element % 64); }

  std::vector<uint64_t> words_;
};

}  // namespace overtone

#endif  // OVERTONE_CORE_ESTIMATION_BIT_SET_H_
