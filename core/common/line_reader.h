// SPDX-License-Identifier: Apache-2.0
// Text line by line, for the readers of trajectories and graphs: bounded memory, errors that name
// the line.
#ifndef OVERTONE_CORE_COMMON_LINE_READER_H_
#define OVERTONE_CORE_COMMON_LINE_READER_H_

#include <array>
#include <cstdint>
#include <istream>
#include <string>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"

namespace overtone {

class LineReader {
 public:
  // A row of any format we read is below 1 kB; what is longer than this is no text of ours, and is
  // not read on.
  static constexpr int kMaxLineLength = 4096;

  // `name` stands for the source in errors, e.g. the file's path. `in` must outlive the reader.
  LineReader(std::istream& in, absl::string_view name);

  // Moves to the next line that is neither blank nor a comment (#) and puts it, without white space
  // at its ends, into `line`, valid until the next call. False at the end and on failure; `status`
  // tells them apart.
  bool Next(absl::string_view* line);

  // Ok, or why reading stopped: a line too long (InvalidArgument), the source failed (DataLoss).
  const absl::Status& status() const { return status_; }

  // InvalidArgument "name:line: what" for the line read last.
  absl::Status Error(absl::string_view what) const;

 private:
  std::istream& in_;
  std::string name_;
  std::array<char, kMaxLineLength + 1> buffer_;
  int64_t line_number_ = 0;
  absl::Status status_;
};

}  // namespace overtone

#endif  // OVERTONE_CORE_COMMON_LINE_READER_H_
