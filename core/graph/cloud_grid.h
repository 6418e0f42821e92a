// SPDX-License-Identifier: Apache-2.0
// The grid of an encoded cloud, and the Morton codes of its cells. Private to the codec.
#ifndef OVERTONE_CORE_GRAPH_CLOUD_GRID_H_
#define OVERTONE_CORE_GRAPH_CLOUD_GRID_H_

#include <array>
#include <cstdint>

namespace overtone {

constexpr int kMaxAxisBits = 21;
// Floats still tell a quarter of a step apart there.
constexpr int64_t kMaxGridIndex = int64_t{1} << 22;

// A point is (lowest + cell) * resolution_m, axis by axis.
struct CloudGrid {
  double resolution_m = 0;
  std::array<int64_t, 3> lowest = {};  // grid steps
  std::array<int, 3> bits = {};        // of a cell's index on each axis, at most kMaxAxisBits

  int code_bits() const { return bits[0] + bits[1] + bits[2]; }
};

// Moves bit i of a word to bit destination[i]; bits without a destination (negative) must be 0.
class BitPermutation {
 public:
  explicit BitPermutation(const std::array<int, 64>& destination) {
    for (int byte = 0; byte < 8; ++byte) {
      for (int value = 1; value < 256; ++value) {
        const int bit = __builtin_ctz(value);
        const int to = destination[8 * byte + bit];
        tables_[byte][value] =
            tables_[byte][value & (value - 1)] | (to < 0 ? 0 : uint64_t{1} << to);
      }
    }
  }

  uint64_t operator()(uint64_t word) const {
    uint64_t moved = 0;
    for (int byte = 0; byte < 8; ++byte) moved |= tables_[byte][(word >> (8 * byte)) & 255];
    return moved;
  }

 private:
  std::array<std::array<uint64_t, 256>, 8> tables_ = {};
};

// A cell as one word: x in the lowest kMaxAxisBits, then y, then z.
inline uint64_t PackCell(uint64_t x, uint64_t y, uint64_t z) {
  return x | y << kMaxAxisBits | z << (2 * kMaxAxisBits);
}
inline int64_t CellIndex(uint64_t cell, int axis) {
  return static_cast<int64_t>((cell >> (axis * kMaxAxisBits)) & ((1 << kMaxAxisBits) - 1));
}

// Packed cell -> Morton code of grid.code_bits() bits, or back.
inline BitPermutation MortonCode(const CloudGrid& grid, bool inverse) {
  std::array<int, 64> destination;
  destination.fill(-1);
  int next = 0;
  for (int bit = 0; bit < kMaxAxisBits; ++bit) {
    for (int axis = 0; axis < 3; ++axis) {
      if (bit >= grid.bits[axis]) continue;
      const int packed = axis * kMaxAxisBits + bit;
      destination[inverse ? next : packed] = inverse ? packed : next;
      ++next;
    }
  }
  return BitPermutation(destination);
}

}  // namespace overtone

#endif  // OVERTONE_CORE_GRAPH_CLOUD_GRID_H_
