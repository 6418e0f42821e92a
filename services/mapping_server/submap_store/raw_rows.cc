// SPDX-License-Identifier: Apache-2.0
// Rows out of raw pages: cells of table leaves, their overflow chains, SQLite's record format.
#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "overtone/services/mapping_server/submap_store/raw_pages.h"

namespace overtone {
namespace {

constexpr char kTableLeaf = 0x0d;
// The largest blob is 16 MiB; damage must not make us take more memory than that many times.
constexpr uint64_t kMaxRowBytes = 128 << 20;
constexpr size_t kMaxColumns = 16;

// Reads forward; everything beyond the end is an error that sticks.
class Reader {
 public:
  explicit Reader(absl::string_view bytes) : rest_(bytes) {}

  uint64_t Varint() {
    uint64_t value = 0;
    for (int i = 0; i < 9; ++i) {
      const uint8_t byte = Byte();
      if (i == 8) return value << 8 | byte;
      value = value << 7 | (byte & 0x7f);
      if ((byte & 0x80) == 0) break;
    }
    return value;
  }
  uint64_t BigEndian(size_t bytes) {
    uint64_t value = 0;
    for (size_t i = 0; i < bytes; ++i) value = value << 8 | Byte();
    return value;
  }
  int64_t Signed(size_t bytes) {
    const uint64_t value = BigEndian(bytes) << (64 - 8 * bytes);
    return static_cast<int64_t>(value) >> (64 - 8 * bytes);
  }
  absl::string_view Take(uint64_t size) {
    if (size > rest_.size()) {
      ok_ = false;
      size = rest_.size();
    }
    const absl::string_view taken = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return taken;
  }
  absl::string_view rest() const { return rest_; }
  bool ok() const { return ok_; }

 private:
  uint8_t Byte() {
    const absl::string_view byte = Take(1);
    return byte.empty() ? 0 : static_cast<uint8_t>(byte[0]);
  }

  absl::string_view rest_;
  bool ok_ = true;
};

RawValue ValueOf(uint64_t serial_type, Reader& content) {
  constexpr size_t kIntegerBytes[] = {0, 1, 2, 3, 4, 6, 8};
  RawValue value;
  if (serial_type >= 1 && serial_type <= 6) {
    value.type = RawValue::Type::kInteger;
    value.integer = content.Signed(kIntegerBytes[serial_type]);
  } else if (serial_type == 8 || serial_type == 9) {
    value.type = RawValue::Type::kInteger;
    value.integer = static_cast<int64_t>(serial_type - 8);
  } else if (serial_type >= 12) {
    const bool is_text = (serial_type & 1) != 0;
    value.type = is_text ? RawValue::Type::kText : RawValue::Type::kBlob;
    value.bytes = std::string(content.Take((serial_type - (is_text ? 13 : 12)) / 2));
  }
  return value;
}

absl::optional<std::vector<RawValue>> ParseRecord(absl::string_view record) {
  Reader size(record);
  const uint64_t header_bytes = size.Varint();
  if (header_bytes > record.size()) return absl::nullopt;
  Reader header(record.substr(0, header_bytes));
  header.Varint();
  Reader content(record.substr(header_bytes));
  std::vector<RawValue> values;
  while (!header.rest().empty() && values.size() <= kMaxColumns) {
    const uint64_t serial_type = header.Varint();
    if (!header.ok()) return absl::nullopt;
    values.push_back(ValueOf(serial_type, content));
  }
  // A row whose tail is gone still says what it was.
  return values;
}

// How much of a payload lies in the leaf itself.
uint64_t LocalBytes(uint64_t payload, uint64_t page_bytes) {
  const uint64_t max_local = page_bytes - 35;
  if (payload <= max_local) return payload;
  const uint64_t min_local = (page_bytes - 12) * 32 / 255 - 23;
  const uint64_t local = min_local + (payload - min_local) % (page_bytes - 4);
  return local <= max_local ? local : min_local;
}

// The rest of a payload, as far as its chain of pages holds together.
void ReadOverflow(const RawPages& pages, uint64_t first, uint64_t size, std::string& payload) {
  for (uint64_t next = first; next != 0 && payload.size() < size;) {
    const std::string page = pages.Page(static_cast<int64_t>(next));
    if (page.empty()) return;
    Reader reader(page);
    next = reader.BigEndian(4);
    const uint64_t rest = std::min<uint64_t>(size - payload.size(), reader.rest().size());
    absl::StrAppend(&payload, reader.Take(rest));
  }
}

absl::optional<RawRow> ParseCell(const RawPages& pages, absl::string_view page, size_t offset) {
  if (offset >= page.size()) return absl::nullopt;
  Reader cell(page.substr(offset));
  const uint64_t size = cell.Varint();
  RawRow row;
  row.id = static_cast<int64_t>(cell.Varint());
  if (!cell.ok() || size > kMaxRowBytes) return absl::nullopt;
  const uint64_t local = LocalBytes(size, page.size());
  std::string payload(cell.Take(local));
  if (!cell.ok()) return absl::nullopt;
  if (local < size) ReadOverflow(pages, cell.BigEndian(4), size, payload);
  absl::optional<std::vector<RawValue>> values = ParseRecord(payload);
  if (!values.has_value()) return absl::nullopt;
  row.values = *std::move(values);
  return row;
}

}  // namespace

void ForEachRawRow(const RawPages& pages, const std::function<void(RawRow row)>& read) {
  for (int64_t number = 1; number <= pages.count(); ++number) {
    const std::string page = pages.Page(number);
    const size_t start = number == 1 ? 100 : 0;  // behind the file's header
    if (page.size() < start + 8 || page[start] != kTableLeaf) continue;
    Reader header(absl::string_view(page).substr(start + 3));
    const uint64_t cells = header.BigEndian(2);
    header.Take(3);
    for (uint64_t i = 0; i < cells; ++i) {
      const size_t offset = header.BigEndian(2);
      if (!header.ok()) break;
      if (absl::optional<RawRow> row = ParseCell(pages, page, offset)) read(*std::move(row));
    }
  }
}

}  // namespace overtone
