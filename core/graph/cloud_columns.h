// SPDX-License-Identifier: Apache-2.0
// What an encoded cloud is made of: little-endian numbers, loose bits, zstd frames. Private to the
// codec.
//   header      version 1, flags (1: intensities), bits of the three axes: a byte each;
//               number of points: 4 bytes; resolution: a double; lowest of the three axes: 4 bytes
//               each; size of the first frame: 4 bytes
//   lengths     zstd frame: the bit length of each difference, a byte each
//   intensities zstd frame, its size (4 bytes) before it; only with the flag
//   remainders  of each difference, the bits below its leading one, lowest first
#ifndef OVERTONE_CORE_GRAPH_CLOUD_COLUMNS_H_
#define OVERTONE_CORE_GRAPH_CLOUD_COLUMNS_H_

#include <cstdint>
#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "overtone/core/graph/cloud_grid.h"

namespace overtone {

struct CloudHeader {
  bool has_intensities = false;
  int64_t num_points = 0;
  CloudGrid grid;
  int64_t lengths_bytes = 0;
};

constexpr size_t kCloudHeaderBytes = 33;

std::string WriteHeader(const CloudHeader& header);
// Takes it off `bytes`. InvalidArgument: too short, another version, a value out of its range.
absl::StatusOr<CloudHeader> TakeHeader(absl::string_view& bytes);

void AppendSize(std::string& out, size_t size);
absl::StatusOr<int64_t> TakeSize(absl::string_view& bytes);

// As one zstd frame. Internal: zstd failed.
absl::StatusOr<std::string> CompressColumn(const std::string& column);
// Takes the first `size` bytes off. InvalidArgument: they are no frame of exactly num_values bytes.
absl::StatusOr<std::string> TakeColumn(absl::string_view& bytes, int64_t size, int64_t num_values);

// Bits into bytes, lowest first.
class BitWriter {
 public:
  explicit BitWriter(std::string* out) : out_(out) {}

  void Put(uint64_t value, int bits) {  // at most 63, value below 2^bits
    for (; bits > 32; bits -= 32, value >>= 32) Put(value & 0xffffffff, 32);
    word_ |= value << held_;
    for (held_ += bits; held_ >= 8; held_ -= 8, word_ >>= 8)
      out_->push_back(static_cast<char>(word_));
  }
  void Flush() {
    if (held_ > 0) out_->push_back(static_cast<char>(word_));
    word_ = 0;
    held_ = 0;
  }

 private:
  std::string* const out_;
  uint64_t word_ = 0;
  int held_ = 0;  // below 8 between calls
};

class BitReader {
 public:
  explicit BitReader(absl::string_view bytes) : bytes_(bytes) {}

  uint64_t Take(int bits) {  // at most 63; no more in all than the bytes hold
    if (bits > 32) {
      const uint64_t low = Take(32);
      return low | Take(bits - 32) << 32;
    }
    for (; held_ < bits; held_ += 8) {
      word_ |= static_cast<uint64_t>(static_cast<uint8_t>(bytes_[next_++])) << held_;
    }
    const uint64_t value = word_ & ((uint64_t{1} << bits) - 1);
    word_ >>= bits;
    held_ -= bits;
    return value;
  }

 private:
  const absl::string_view bytes_;
  size_t next_ = 0;
  uint64_t word_ = 0;
  int held_ = 0;
};

}  // namespace overtone

#endif  // OVERTONE_CORE_GRAPH_CLOUD_COLUMNS_H_
