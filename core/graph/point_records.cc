// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/graph/point_records.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "absl/strings/escaping.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {
namespace {

constexpr int64_t kChunkBytes = 1 << 16;

// Where the elements we want lie in a record.
struct Position {
  const PointField* field = nullptr;  // null: the record has none
  int64_t element = 0;                // counted in elements, for text
  int64_t byte = 0;
};

struct RecordShape {
  Position x, y, z, intensity;
  int64_t elements = 0;
  int64_t bytes = 0;
};

absl::StatusOr<RecordShape> FindFields(const std::vector<PointField>& fields) {
  RecordShape shape;
  for (const PointField& field : fields) {
    Position* wanted = field.name == "x"                  ? &shape.x
                       : field.name == "y"                ? &shape.y
                       : field.name == "z"                ? &shape.z
                       : field.name == "intensity"        ? &shape.intensity
                       : field.name == "scalar_intensity" ? &shape.intensity
                                                          : nullptr;
    if (wanted != nullptr) {
      if (wanted->field != nullptr || field.count != 1) {
        return absl::InvalidArgumentError(absl::StrCat("more than one ", field.name, " a point"));
      }
      if (wanted != &shape.intensity && field.kind != PointField::Kind::kFloat) {
        return absl::InvalidArgumentError(absl::StrCat(field.name, " is not a float"));
      }
      *wanted = {&field, shape.elements, shape.bytes};
    }
    shape.elements += field.count;
    shape.bytes += field.count * field.bytes;
  }
  for (const Position* required : {&shape.x, &shape.y, &shape.z}) {
    if (required->field == nullptr)
      return absl::InvalidArgumentError("not all of x, y, z are there");
  }
  return shape;
}

template <typename T>
double Load(const char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return static_cast<double>(value);
}

double Decode(const char* record, const Position& position) {
  const char* bytes = record + position.byte;
  const int size = position.field->bytes;
  switch (position.field->kind) {
    case PointField::Kind::kFloat:
      return size == 4 ? Load<float>(bytes) : Load<double>(bytes);
    case PointField::Kind::kSigned:
      return size == 1   ? Load<int8_t>(bytes)
             : size == 2 ? Load<int16_t>(bytes)
             : size == 4 ? Load<int32_t>(bytes)
                         : Load<int64_t>(bytes);
    case PointField::Kind::kUnsigned:
      return size == 1   ? Load<uint8_t>(bytes)
             : size == 2 ? Load<uint16_t>(bytes)
             : size == 4 ? Load<uint32_t>(bytes)
                         : Load<uint64_t>(bytes);
  }
  return std::numeric_limits<double>::quiet_NaN();
}

// Leaves out what is not finite; scales the intensities when all of them are known.
class CloudBuilder {
 public:
  CloudBuilder(int64_t num_records, bool has_intensity) : has_intensity_(has_intensity) {
    cloud_.points.reserve(num_records);
    if (has_intensity) intensities_.reserve(num_records);
  }

  void Add(double x, double y, double z, double intensity) {
    const Eigen::Vector3f point = Eigen::Vector3d(x, y, z).cast<float>();
    if (!point.allFinite()) return;
    cloud_.points.push_back(point);
    if (has_intensity_) intensities_.push_back(std::isfinite(intensity) ? intensity : 0);
  }

  PointCloud Finish() && {
    const auto beyond_one = [](float v) { return v < 0 || v > 1; };
    const auto fraction = [](float v) { return v != std::floor(v); };
    const bool unit_scale = std::none_of(intensities_.begin(), intensities_.end(), beyond_one) &&
                            std::any_of(intensities_.begin(), intensities_.end(), fraction);
    cloud_.intensities.reserve(intensities_.size());
    for (const float intensity : intensities_) {
      const float scaled = std::clamp(unit_scale ? 255 * intensity : intensity, 0.f, 255.f);
      cloud_.intensities.push_back(static_cast<uint8_t>(std::lround(scaled)));
    }
    return std::move(cloud_);
  }

 private:
  const bool has_intensity_;
  PointCloud cloud_;
  std::vector<float> intensities_;
};

absl::StatusOr<PointCloud> ReadText(LineReader& lines, const RecordShape& shape,
                                    int64_t num_records) {
  CloudBuilder builder(num_records, shape.intensity.field != nullptr);
  absl::string_view line;
  for (int64_t record = 0; record < num_records; ++record) {
    if (!lines.Next(&line)) {
      RETURN_IF_ERROR(lines.status());
      return lines.Error(absl::StrCat("ends after ", record, " of ", num_records, " points"));
    }
    const std::vector<absl::string_view> texts =
        absl::StrSplit(line, absl::ByAnyChar(" \t"), absl::SkipEmpty());
    if (texts.size() != shape.elements) {
      return lines.Error(
          absl::StrCat(texts.size(), " numbers where ", shape.elements, " are expected"));
    }
    double values[4] = {0, 0, 0, 0};
    const Position* positions[4] = {&shape.x, &shape.y, &shape.z, &shape.intensity};
    for (int i = 0; i < 4; ++i) {
      if (positions[i]->field == nullptr) continue;
      const absl::string_view text = texts[positions[i]->element];
      if (!absl::SimpleAtod(text, &values[i])) {  // takes "nan" and "inf", as they are written
        return lines.Error(absl::StrCat("not a number: '", absl::CEscape(text.substr(0, 40)), "'"));
      }
    }
    builder.Add(values[0], values[1], values[2], values[3]);
  }
  return std::move(builder).Finish();
}

absl::StatusOr<PointCloud> ReadBinary(std::istream& in, const LineReader& header,
                                      const RecordShape& shape, int64_t num_records) {
  CloudBuilder builder(num_records, shape.intensity.field != nullptr);
  const int64_t chunk = std::max<int64_t>(1, kChunkBytes / shape.bytes);
  std::vector<char> buffer(std::min(chunk, num_records) * shape.bytes);
  for (int64_t done = 0; done < num_records; done += chunk) {
    const int64_t records = std::min(chunk, num_records - done);
    in.read(buffer.data(), records * shape.bytes);
    if (!in) return absl::DataLossError(header.Error("the points cannot be read").message());
    for (int64_t i = 0; i < records; ++i) {
      const char* record = buffer.data() + i * shape.bytes;
      builder.Add(Decode(record, shape.x), Decode(record, shape.y), Decode(record, shape.z),
                  shape.intensity.field != nullptr ? Decode(record, shape.intensity) : 0);
    }
  }
  return std::move(builder).Finish();
}

}  // namespace

absl::StatusOr<PointCloud> ReadPointRecords(std::istream& in, LineReader& header,
                                            const PointRecordLayout& layout, int64_t bytes_left) {
  const auto shape = FindFields(layout.fields);
  if (!shape.ok()) return header.Error(shape.status().message());
  // A number of text is a digit and what parts it from the next; at the very end nothing needs to.
  const int64_t record_bytes = layout.ascii ? 2 * shape->elements : shape->bytes;
  const int64_t room = (bytes_left + (layout.ascii ? 1 : 0)) / record_bytes;
  if (layout.num_records > room) {
    return header.Error(absl::StrCat(layout.num_records, " points are announced, but there are ",
                                     bytes_left, " bytes, room for ", room));
  }
  return layout.ascii ? ReadText(header, *shape, layout.num_records)
                      : ReadBinary(in, header, *shape, layout.num_records);
}

}  // namespace overtone
