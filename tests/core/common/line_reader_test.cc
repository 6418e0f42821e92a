// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/common/line_reader.h"

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "gtest/gtest.h"

namespace overtone {
namespace {

std::vector<std::string> Lines(LineReader& reader) {
  std::vector<std::string> lines;
  absl::string_view line;
  while (reader.Next(&line)) lines.emplace_back(line);
  return lines;
}

TEST(LineReader, PassesOverBlankLinesAndCommentsAndStripsWhiteSpace) {
  std::istringstream in("# comment\n\n  \t\r\n a b \r\n  # indented\nlast");
  LineReader reader(in, "file");
  EXPECT_EQ(Lines(reader), (std::vector<std::string>{"a b", "last"}));
  EXPECT_TRUE(reader.status().ok());
}

TEST(LineReader, ErrorsNameTheSourceAndTheLineAsAnEditorCountsThem) {
  std::istringstream in("# comment\n\nrow\n");
  LineReader reader(in, "data/run.tum");
  absl::string_view line;
  ASSERT_TRUE(reader.Next(&line));
  EXPECT_EQ(reader.Error("what").message(), "data/run.tum:3: what");
}

TEST(LineReader, TakesTheLongestLineAndRefusesOneMore) {
  const std::string longest(LineReader::kMaxLineLength, 'x');
  std::istringstream fits(longest + "\n" + longest + "\nrow");
  LineReader reader(fits, "file");
  EXPECT_EQ(Lines(reader), (std::vector<std::string>{longest, longest, "row"}));
  EXPECT_TRUE(reader.status().ok()) << reader.status();

  std::istringstream too_long("row\n" + longest + "x\nrow");
  LineReader refusing(too_long, "file");
  EXPECT_EQ(Lines(refusing), (std::vector<std::string>{"row"}));
  EXPECT_EQ(refusing.status().message(), "file:2: longer than 4096 characters");
}

TEST(LineReader, AnUnreadableSourceIsDataLossNotAnEmptyFile) {
  std::ifstream directory("/");
  LineReader reader(directory, "/");
  EXPECT_TRUE(Lines(reader).empty());
  EXPECT_EQ(reader.status().code(), absl::StatusCode::kDataLoss) << reader.status();
}

}  // namespace
}  // namespace overtone
