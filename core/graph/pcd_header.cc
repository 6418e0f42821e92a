// SPDX-License-Identifier: Apache-2.0
// PCD v0.7: VERSION, FIELDS, SIZE, TYPE, COUNT, WIDTH, HEIGHT, VIEWPOINT, POINTS, DATA, a line
// each; COUNT may be left out.
#include <algorithm>
#include <optional>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "overtone/core/common/parse_number.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/graph/point_records.h"

namespace overtone {
namespace {

using Values = std::vector<absl::string_view>;

bool IsProduct(int64_t product, int64_t a, int64_t b) {  // without overflow
  return a == 0 ? product == 0 : product % a == 0 && product / a == b;
}

class PcdHeader {
 public:
  absl::Status Parse(absl::string_view key, const Values& values) {
    if (key == "VERSION" || key == "VIEWPOINT") return absl::OkStatus();
    if (key == "FIELDS") {
      layout_.fields.resize(values.size());
      for (size_t i = 0; i < values.size(); ++i) layout_.fields[i].name = std::string(values[i]);
      return absl::OkStatus();
    }
    if (key == "SIZE") return ForEachField(key, values, ParseSize);
    if (key == "TYPE") return ForEachField(key, values, ParseType);
    if (key == "COUNT") return ForEachField(key, values, ParseCount);
    if (key == "WIDTH") return ParseSingle(key, values, width_);
    if (key == "HEIGHT") return ParseSingle(key, values, height_);
    if (key == "POINTS") return ParseSingle(key, values, points_);
    return absl::InvalidArgumentError(
        absl::StrCat("no line of a PCD header: '", absl::CEscape(key.substr(0, 40)), "'"));
  }

  absl::StatusOr<PointRecordLayout> Finish(const Values& data) {
    if (data == Values{"binary_compressed"}) {
      return absl::UnimplementedError("binary_compressed is not read; convert to binary");
    }
    if (data != Values{"ascii"} && data != Values{"binary"}) {
      return absl::InvalidArgumentError("DATA is neither ascii nor binary");
    }
    layout_.ascii = data[0] == "ascii";
    for (const PointField& field : layout_.fields) {
      if (field.kind == PointField::Kind::kFloat && field.bytes < 4) {
        return absl::InvalidArgumentError(absl::StrCat("a float of ", field.bytes, " bytes"));
      }
    }
    if (!points_.has_value()) return absl::InvalidArgumentError("no POINTS before DATA");
    if (width_.has_value() && height_.has_value() && !IsProduct(*points_, *width_, *height_)) {
      return absl::InvalidArgumentError("POINTS is not WIDTH x HEIGHT");
    }
    layout_.num_records = *points_;
    return layout_;
  }

 private:
  static absl::Status ParseSize(absl::string_view text, PointField& field) {
    ASSIGN_OR_RETURN(const int64_t size, ParseNonNegativeInteger(text));
    if (size != 1 && size != 2 && size != 4 && size != 8) {
      return absl::InvalidArgumentError("SIZE is not 1, 2, 4 or 8");
    }
    field.bytes = static_cast<int>(size);
    return absl::OkStatus();
  }

  static absl::Status ParseType(absl::string_view text, PointField& field) {
    if (text == "F") field.kind = PointField::Kind::kFloat;
    if (text == "I") field.kind = PointField::Kind::kSigned;
    if (text == "U") field.kind = PointField::Kind::kUnsigned;
    if (text == "F" || text == "I" || text == "U") return absl::OkStatus();
    return absl::InvalidArgumentError("TYPE is not F, I or U");
  }

  static absl::Status ParseCount(absl::string_view text, PointField& field) {
    ASSIGN_OR_RETURN(field.count, ParseNonNegativeInteger(text));
    if (field.count >= 1 && field.count <= 1 << 16) return absl::OkStatus();
    return absl::InvalidArgumentError("COUNT is not in [1, 65536]");
  }

  absl::Status ForEachField(absl::string_view key, const Values& values,
                            absl::Status (*parse)(absl::string_view, PointField&)) {
    if (values.size() != layout_.fields.size()) {
      return absl::InvalidArgumentError(
          absl::StrCat(key, " has ", values.size(), " entries, FIELDS ", layout_.fields.size()));
    }
    for (size_t i = 0; i < values.size(); ++i) RETURN_IF_ERROR(parse(values[i], layout_.fields[i]));
    return absl::OkStatus();
  }

  static absl::Status ParseSingle(absl::string_view key, const Values& values,
                                  std::optional<int64_t>& number) {
    if (values.size() != 1)
      return absl::InvalidArgumentError(absl::StrCat(key, " is not one number"));
    ASSIGN_OR_RETURN(number, ParseNonNegativeInteger(values[0]));
    return absl::OkStatus();
  }

  PointRecordLayout layout_;
  std::optional<int64_t> width_, height_, points_;
};

}  // namespace

absl::StatusOr<PointRecordLayout> ReadPcdHeader(LineReader& lines) {
  PcdHeader header;
  absl::string_view line;
  while (lines.Next(&line)) {
    Values values = absl::StrSplit(line, absl::ByAnyChar(" \t"), absl::SkipEmpty());
    const absl::string_view key = values.front();
    values.erase(values.begin());
    if (key == "DATA") {
      auto layout = header.Finish(values);
      if (layout.ok()) return layout;
      return absl::Status(layout.status().code(), lines.Error(layout.status().message()).message());
    }
    const absl::Status parsed = header.Parse(key, values);
    if (!parsed.ok()) return lines.Error(parsed.message());
  }
  RETURN_IF_ERROR(lines.status());
  return lines.Error("the header ends without DATA");
}

}  // namespace overtone
