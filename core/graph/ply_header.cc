// SPDX-License-Identifier: Apache-2.0
// PLY 1.0. The vertices must be the first element; what follows them (faces) is not read.
#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "overtone/core/common/parse_number.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/graph/point_records.h"

namespace overtone {
namespace {

using Words = std::vector<absl::string_view>;

struct PlyType {
  absl::string_view name;
  PointField::Kind kind;
  int bytes;
};

constexpr PlyType kTypes[] = {
    {"char", PointField::Kind::kSigned, 1},     {"int8", PointField::Kind::kSigned, 1},
    {"uchar", PointField::Kind::kUnsigned, 1},  {"uint8", PointField::Kind::kUnsigned, 1},
    {"short", PointField::Kind::kSigned, 2},    {"int16", PointField::Kind::kSigned, 2},
    {"ushort", PointField::Kind::kUnsigned, 2}, {"uint16", PointField::Kind::kUnsigned, 2},
    {"int", PointField::Kind::kSigned, 4},      {"int32", PointField::Kind::kSigned, 4},
    {"uint", PointField::Kind::kUnsigned, 4},   {"uint32", PointField::Kind::kUnsigned, 4},
    {"float", PointField::Kind::kFloat, 4},     {"float32", PointField::Kind::kFloat, 4},
    {"double", PointField::Kind::kFloat, 8},    {"float64", PointField::Kind::kFloat, 8},
};

class PlyHeader {
 public:
  absl::Status Parse(const Words& words) {
    const absl::string_view key = words[0];
    if (key == "comment" || key == "obj_info") return absl::OkStatus();
    if (key == "format" && words.size() == 3) return ParseFormat(words[1]);
    if (key == "element" && words.size() == 3) return ParseElement(words);
    if (key == "property" && words.size() >= 3) return ParseProperty(words);
    return absl::InvalidArgumentError(
        absl::StrCat("no line of a PLY header: '", absl::CEscape(key.substr(0, 40)), "'"));
  }

  absl::StatusOr<PointRecordLayout> Finish() const {
    if (!has_format_) return absl::InvalidArgumentError("no format before end_header");
    if (num_elements_ == 0) return absl::InvalidArgumentError("no element vertex");
    return layout_;
  }

 private:
  absl::Status ParseFormat(absl::string_view format) {
    if (format == "binary_big_endian") {
      return absl::UnimplementedError("binary_big_endian is not read");
    }
    if (format != "ascii" && format != "binary_little_endian") {
      return absl::InvalidArgumentError("the format is neither ascii nor binary_little_endian");
    }
    layout_.ascii = format == "ascii";
    has_format_ = true;
    return absl::OkStatus();
  }

  absl::Status ParseElement(const Words& words) {
    if (++num_elements_ > 1) return absl::OkStatus();
    if (words[1] != "vertex") return absl::InvalidArgumentError("the first element is not vertex");
    ASSIGN_OR_RETURN(layout_.num_records, ParseNonNegativeInteger(words[2]));
    return absl::OkStatus();
  }

  absl::Status ParseProperty(const Words& words) {
    if (num_elements_ == 0) return absl::InvalidArgumentError("a property before any element");
    if (num_elements_ > 1) return absl::OkStatus();
    for (const PlyType& type : kTypes) {
      if (words[1] != type.name || words.size() != 3) continue;
      layout_.fields.push_back({std::string(words[2]), type.kind, type.bytes});
      return absl::OkStatus();
    }
    return absl::InvalidArgumentError("a vertex property of a type that is not read");
  }

  PointRecordLayout layout_;
  bool has_format_ = false;
  int num_elements_ = 0;
};

}  // namespace

absl::StatusOr<PointRecordLayout> ReadPlyHeader(LineReader& lines) {
  const auto error = [&lines](const absl::Status& status) {
    return absl::Status(status.code(), lines.Error(status.message()).message());
  };
  PlyHeader header;
  absl::string_view line;
  if (!lines.Next(&line) || line != "ply") return lines.Error("does not begin with ply");
  while (lines.Next(&line)) {
    if (line == "end_header") {
      auto layout = header.Finish();
      if (!layout.ok()) return error(layout.status());
      return layout;
    }
    const Words words = absl::StrSplit(line, absl::ByAnyChar(" \t"), absl::SkipEmpty());
    const absl::Status parsed = header.Parse(words);
    if (!parsed.ok()) return error(parsed);
  }
  RETURN_IF_ERROR(lines.status());
  return lines.Error("the header ends without end_header");
}

}  // namespace overtone
