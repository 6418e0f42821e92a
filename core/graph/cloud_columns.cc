// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/graph/cloud_columns.h"

#include <cstdlib>
#include <cstring>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/graph/point_cloud_codec.h"
#include "zstd.h"

namespace overtone {
namespace {

constexpr uint64_t kVersion = 1;
constexpr int kZstdLevel = 1;  // only its Huffman stage helps here, and that is the same at all

void AppendNumber(std::string& out, uint64_t value, int bytes) {
  for (int i = 0; i < bytes; ++i) out.push_back(static_cast<char>(value >> (8 * i)));
}

// `bytes` is long enough.
uint64_t TakeNumber(absl::string_view& bytes, int count) {
  uint64_t value = 0;
  for (int i = 0; i < count; ++i) {
    value |= static_cast<uint64_t>(static_cast<uint8_t>(bytes[i])) << (8 * i);
  }
  bytes.remove_prefix(count);
  return value;
}

absl::Status Invalid(absl::string_view what) {
  return absl::InvalidArgumentError(absl::StrCat("encoded cloud: ", what));
}

}  // namespace

std::string WriteHeader(const CloudHeader& header) {
  std::string out;
  AppendNumber(out, kVersion, 1);
  AppendNumber(out, header.has_intensities ? 1 : 0, 1);
  for (const int bits : header.grid.bits) AppendNumber(out, bits, 1);
  AppendNumber(out, header.num_points, 4);
  uint64_t resolution = 0;
  std::memcpy(&resolution, &header.grid.resolution_m, sizeof(resolution));
  AppendNumber(out, resolution, 8);
  for (const int64_t lowest : header.grid.lowest) AppendNumber(out, lowest, 4);
  AppendSize(out, header.lengths_bytes);
  return out;
}

absl::StatusOr<CloudHeader> TakeHeader(absl::string_view& bytes) {
  if (bytes.size() < kCloudHeaderBytes) return Invalid("shorter than its header");
  if (TakeNumber(bytes, 1) != kVersion) return Invalid("of an unknown version");
  const uint64_t flags = TakeNumber(bytes, 1);
  if (flags > 1) return Invalid("unknown flags");
  CloudHeader header;
  header.has_intensities = flags == 1;
  for (int& bits : header.grid.bits) {
    bits = static_cast<int>(TakeNumber(bytes, 1));
    if (bits > kMaxAxisBits) return Invalid(absl::StrCat(bits, " bits on an axis"));
  }
  header.num_points = static_cast<int64_t>(TakeNumber(bytes, 4));
  const uint64_t resolution = TakeNumber(bytes, 8);
  std::memcpy(&header.grid.resolution_m, &resolution, sizeof(resolution));
  RETURN_IF_ERROR(CloudCodecOptions{header.grid.resolution_m}.Validate());
  for (int64_t& lowest : header.grid.lowest) {
    lowest = static_cast<int32_t>(TakeNumber(bytes, 4));
    if (std::abs(lowest) > kMaxGridIndex) return Invalid("too far from the origin");
  }
  header.lengths_bytes = static_cast<int64_t>(TakeNumber(bytes, 4));
  return header;
}

void AppendSize(std::string& out, size_t size) { AppendNumber(out, size, 4); }

absl::StatusOr<int64_t> TakeSize(absl::string_view& bytes) {
  if (bytes.size() < 4) return Invalid("cut short");
  return static_cast<int64_t>(TakeNumber(bytes, 4));
}

absl::StatusOr<std::string> CompressColumn(const std::string& column) {
  std::string frame(ZSTD_compressBound(column.size()), '\0');
  const size_t size =
      ZSTD_compress(frame.data(), frame.size(), column.data(), column.size(), kZstdLevel);
  if (ZSTD_isError(size))
    return absl::InternalError(absl::StrCat("zstd: ", ZSTD_getErrorName(size)));
  frame.resize(size);
  return frame;
}

absl::StatusOr<std::string> TakeColumn(absl::string_view& bytes, int64_t size, int64_t num_values) {
  if (static_cast<int64_t>(bytes.size()) < size) return Invalid("cut short");
  const absl::string_view frame = bytes.substr(0, size);
  bytes.remove_prefix(size);
  const unsigned long long promised = ZSTD_getFrameContentSize(frame.data(), frame.size());
  if (promised != static_cast<unsigned long long>(num_values)) {
    return Invalid("a column is not as long as the cloud");
  }
  std::string column(num_values, '\0');
  const size_t written = ZSTD_decompress(column.data(), column.size(), frame.data(), frame.size());
  if (ZSTD_isError(written) || written != column.size()) return Invalid("a column is damaged");
  return column;
}

}  // namespace overtone
