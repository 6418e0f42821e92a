// SPDX-License-Identifier: Apache-2.0
// A few bytes that claim to be many: refused before the memory for them is taken.
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "gtest/gtest.h"
#include "overtone/core/graph/point_cloud_codec.h"
#include "overtone/proto/conversion/graph_columns.h"
#include "overtone/services/mapping_server/rpc/blob_assembly.h"
#include "overtone/services/mapping_server/submap_store/log_compression.h"
#include "overtone/tests/support/largest_allocation.h"
#include "zstd.h"

namespace overtone {
namespace {

using testing::TakeLargestAllocation;

constexpr size_t kLittle = 64 << 10;

std::string ZstdFrame(const std::string& content) {
  std::string frame(ZSTD_compressBound(content.size()), '\0');
  frame.resize(ZSTD_compress(frame.data(), frame.size(), content.data(), content.size(), 1));
  return frame;
}

// A frame header that promises `size` bytes, and no content. RFC 8878, 3.1.1.1.
std::string ZstdPromise(uint64_t size) {
  std::string frame("\x28\xb5\x2f\xfd\xe0", 5);  // single segment, 8 bytes of content size
  for (int i = 0; i < 8; ++i) frame.push_back(static_cast<char>(size >> (8 * i)));
  return frame + std::string(20, '\0');
}

// The largest allocation while `decode` runs, which must not succeed.
template <typename Decode>
size_t Cost(Decode decode) {
  TakeLargestAllocation();
  EXPECT_FALSE(decode());
  return TakeLargestAllocation();
}

// Of the good encoding's columns only the first is touched: it begins behind the header, whose
// length in bytes stands at its end.
std::string CloudWith(const std::string& column, uint32_t num_points) {
  PointCloud cloud;
  cloud.points.assign(100, Eigen::Vector3f::Zero());
  std::string bytes = *EncodePointCloud(cloud, {});
  constexpr size_t kNumPointsAt = 5;
  constexpr size_t kLengthAt = 29;
  constexpr size_t kHeader = 33;
  const uint32_t length = static_cast<uint32_t>(column.size());
  std::memcpy(&bytes[kNumPointsAt], &num_points, sizeof(num_points));
  std::memcpy(&bytes[kLengthAt], &length, sizeof(length));
  return bytes.substr(0, kHeader) + column;
}

TEST(DecompressionBombs, TheRulerMeasures) {
  TakeLargestAllocation();
  const std::vector<char> memory(1 << 20);
  EXPECT_GE(TakeLargestAllocation(), memory.size());
}

TEST(DecompressionBombs, ACloudThatClaimsMoreThanTheLimitCostsNothing) {
  const CloudCodecLimits limits{/*max_points=*/1000};
  const std::string column = ZstdFrame(std::string(64 << 20, '\0'));
  EXPECT_LT(column.size(), 16u << 10);
  for (const uint32_t claimed : {1001u, 64u << 20, 4'000'000'000u}) {
    const std::string bytes = CloudWith(column, claimed);
    EXPECT_LE(Cost([&] { return DecodePointCloud(bytes, limits).ok(); }), kLittle) << claimed;
  }
  // What is unpacked is what the header claims, never what the frame holds or promises.
  for (const std::string& frame : {column, ZstdPromise(~uint64_t{0}), ZstdPromise(1 << 30)}) {
    const std::string bytes = CloudWith(frame, 1000);
    EXPECT_LE(Cost([&] { return DecodePointCloud(bytes, limits).ok(); }), kLittle);
  }
}

// It may claim all the points that a cloud may have: the first column takes a byte for each, and
// does not bear it out.
TEST(DecompressionBombs, ACloudWhoseColumnsDoNotBearItOutCostsOneColumn) {
  const std::string bytes = CloudWith(ZstdPromise(kMaxCloudPoints), kMaxCloudPoints);
  EXPECT_LE(Cost([&] { return DecodePointCloud(bytes).ok(); }), kMaxCloudPoints + kLittle);
}

TEST(DecompressionBombs, ALogEntryThatPromisesMoreThanTheLimitCostsNothing) {
  for (const uint64_t promised : {uint64_t{65} << 20, uint64_t{1} << 40, ~uint64_t{0} - 1}) {
    const std::string frame = ZstdPromise(promised);
    const auto decode = [&] { return !DecodeLogBytes(LogEncoding::kZstd, frame).empty(); };
    EXPECT_LE(Cost(decode), kLittle) << promised;
  }
  // The frame says less than it holds: no more than it said is written.
  std::string liar = ZstdPromise(10).substr(0, 13) + ZstdFrame(std::string(1 << 20, 'x')).substr(9);
  EXPECT_LE(Cost([&] { return !DecodeLogBytes(LogEncoding::kZstd, liar).empty(); }), kLittle);
}

TEST(DecompressionBombs, ColumnsOfDifferentLengthCostNothing) {
  v1::NodeColumns columns;
  for (int i = 0; i < 1'000'000; ++i) columns.add_index(1);
  EXPECT_LE(Cost([&] { return DecodeColumns(columns, ColumnUnits()).ok(); }), kLittle);
}

TEST(DecompressionBombs, ABlobTakesMemoryOnlyForWhatHasArrived) {
  BlobAssembly assembly(/*max_blob_bytes=*/16 << 20);
  v1::BlobChunk chunk;
  chunk.set_sha256(std::string(32, 'a'));
  chunk.set_data(std::string(1000, 'b'));
  TakeLargestAllocation();
  EXPECT_FALSE(assembly.Take(chunk, /*wanted_bytes=*/16 << 20).has_value());
  EXPECT_LE(TakeLargestAllocation(), kLittle);
}

}  // namespace
}  // namespace overtone
