// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/submap_store/raw_pages.h"

#include <algorithm>
#include <utility>

namespace overtone {
namespace {

constexpr int64_t kLogHeaderBytes = 32;
constexpr int64_t kFrameHeaderBytes = 24;

uint32_t BigEndian32(absl::string_view bytes, size_t at) {
  uint32_t value = 0;
  for (size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<uint8_t>(bytes[at + i]);
  return value;
}

uint32_t LittleEndian32(absl::string_view bytes, size_t at) {
  uint32_t value = 0;
  for (size_t i = 4; i-- > 0;) value = value << 8 | static_cast<uint8_t>(bytes[at + i]);
  return value;
}

std::string ReadAt(std::ifstream& file, int64_t offset, int64_t size) {
  std::string bytes(static_cast<size_t>(size), '\0');
  file.clear();
  file.seekg(offset);
  file.read(bytes.data(), size);
  bytes.resize(static_cast<size_t>(std::max<int64_t>(0, file.gcount())));
  return bytes;
}

int64_t SizeOf(std::ifstream& file) {
  file.clear();
  file.seekg(0, std::ios::end);
  return std::max<int64_t>(0, file.tellg());
}

bool IsPageSize(int64_t bytes) {
  return bytes >= 512 && bytes <= 65536 && (bytes & (bytes - 1)) == 0;
}

// The running checksum of the write-ahead log.
class LogChecksum {
 public:
  explicit LogChecksum(bool big_endian) : read_(big_endian ? BigEndian32 : LittleEndian32) {}
  void Add(absl::string_view bytes) {
    for (size_t i = 0; i + 8 <= bytes.size(); i += 8) {
      first_ += read_(bytes, i) + second_;
      second_ += read_(bytes, i + 4) + first_;
    }
  }
  bool Is(absl::string_view bytes, size_t at) const {
    return BigEndian32(bytes, at) == first_ && BigEndian32(bytes, at + 4) == second_;
  }

 private:
  uint32_t (*const read_)(absl::string_view, size_t);
  uint32_t first_ = 0;
  uint32_t second_ = 0;
};

}  // namespace

RawPages::RawPages(const std::string& path)
    : file_(path, std::ios::binary), log_(path + "-wal", std::ios::binary) {
  const std::string header = ReadAt(file_, 0, 100);
  if (header.size() == 100) {
    const int64_t bytes = BigEndian32(header, 14) & 0xffff;  // at 16, 2 bytes; 1 means 65536
    if (IsPageSize(bytes == 1 ? 65536 : bytes)) page_bytes_ = bytes == 1 ? 65536 : bytes;
  }
  count_ = (SizeOf(file_) + page_bytes_ - 1) / page_bytes_;
  ReadLog();
}

void RawPages::ReadLog() {
  const std::string header = ReadAt(log_, 0, kLogHeaderBytes);
  if (header.size() < static_cast<size_t>(kLogHeaderBytes)) return;
  LogChecksum checksum((BigEndian32(header, 0) & 1) != 0);
  checksum.Add(absl::string_view(header).substr(0, 24));
  if (BigEndian32(header, 8) != page_bytes_ || !checksum.Is(header, 24)) return;
  std::map<int64_t, int64_t> uncommitted;
  for (int64_t offset = kLogHeaderBytes;; offset += kFrameHeaderBytes + page_bytes_) {
    const std::string frame = ReadAt(log_, offset, kFrameHeaderBytes + page_bytes_);
    if (frame.size() < static_cast<size_t>(kFrameHeaderBytes + page_bytes_)) return;
    checksum.Add(absl::string_view(frame).substr(0, 8));
    checksum.Add(absl::string_view(frame).substr(kFrameHeaderBytes));
    const bool of_this_log = frame.compare(8, 8, header, 16, 8) == 0;
    if (!of_this_log || !checksum.Is(frame, 16)) return;
    uncommitted[BigEndian32(frame, 0)] = offset + kFrameHeaderBytes;
    if (const int64_t pages = BigEndian32(frame, 4); pages > 0) {
      for (const auto& [page, where] : uncommitted) in_log_[page] = where;
      uncommitted.clear();
      count_ = std::max(count_, pages);
    }
  }
}

std::string RawPages::Page(int64_t number) const {
  if (number < 1 || number > count_) return "";
  const auto it = in_log_.find(number);
  std::string page = it != in_log_.end() ? ReadAt(log_, it->second, page_bytes_)
                                         : ReadAt(file_, (number - 1) * page_bytes_, page_bytes_);
  if (!page.empty()) page.resize(static_cast<size_t>(page_bytes_), '\0');
  return page;
}

}  // namespace overtone
