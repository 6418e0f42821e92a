// SPDX-License-Identifier: Apache-2.0
// A sequence that grows at its end, in blocks of a fixed size: growing moves nothing and wastes no
// more than a block, where a std::vector moves all and wastes up to half.
#ifndef OVERTONE_CORE_COMMON_BLOCK_VECTOR_H_
#define OVERTONE_CORE_COMMON_BLOCK_VECTOR_H_

#include <cstddef>
#include <utility>
#include <vector>

namespace overtone {

template <typename T>
class BlockVector {
 public:
  size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }

  T& operator[](size_t i) { return blocks_[i / kBlock][i % kBlock]; }
  const T& operator[](size_t i) const { return blocks_[i / kBlock][i % kBlock]; }
  const T& back() const { return (*this)[size_ - 1]; }

  void push_back(T value) {
    if (size_ % kBlock == 0) blocks_.emplace_back().reserve(kBlock);
    blocks_.back().push_back(std::move(value));
    ++size_;
  }
  // new_size <= size().
  void truncate(size_t new_size) {
    blocks_.resize((new_size + kBlock - 1) / kBlock);
    if (new_size % kBlock != 0) blocks_.back().resize(new_size % kBlock);
    size_ = new_size;
  }

 private:
  static constexpr size_t kBlock = 32;

  std::vector<std::vector<T>> blocks_;
  size_t size_ = 0;
};

}  // namespace overtone

#endif  // OVERTONE_CORE_COMMON_BLOCK_VECTOR_H_
