// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/common/line_reader.h"

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"

namespace overtone {

LineReader::LineReader(std::istream& in, absl::string_view name) : in_(in), name_(name) {}

bool LineReader::Next(absl::string_view* line) {
  while (status_.ok() && in_.good()) {
    in_.getline(buffer_.data(), buffer_.size());
    if (in_.bad()) {
      status_ = absl::DataLossError(absl::StrCat(name_, ": cannot be read"));
      return false;
    }
    // getline counts the newline it swallows; at the end of the source there is none.
    const auto length = in_.gcount() - (in_.eof() || in_.fail() ? 0 : 1);
    if (in_.fail() && in_.eof()) return false;
    ++line_number_;
    if (in_.fail()) {
      status_ = Error(absl::StrCat("longer than ", kMaxLineLength, " characters"));
      return false;
    }
    *line = absl::StripAsciiWhitespace(absl::string_view(buffer_.data(), length));
    if (!line->empty() && line->front() != '#') return true;
  }
  return false;
}

absl::Status LineReader::Error(absl::string_view what) const {
  return absl::InvalidArgumentError(absl::StrCat(name_, ":", line_number_, ": ", what));
}

}  // namespace overtone
