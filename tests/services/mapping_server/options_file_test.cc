// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/options_file.h"

#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_split.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace overtone {
namespace {

using ::testing::HasSubstr;

std::string Write(const std::string& text) {
  const std::string path = ::testing::TempDir() + "/options.yaml";
  std::ofstream(path) << text;
  return path;
}

absl::Status Read(const std::string& path, ServerOptions& options) {
  OptionSources sources;
  return ReadOptionsFile(path, options, sources);
}

TEST(OptionsFile, TheDefaultsAreValid) {
  const absl::Status status = ServerOptions().Validate();
  EXPECT_TRUE(status.ok()) << status;
}

// Another value of the same type.
std::string Spoilt(const std::string& key, const std::string& value) {
  double number = 0;
  if (key == "map.robust") return "none";
  if (value == "true" || value == "false") return value == "true" ? "false" : "true";
  return absl::SimpleAtod(value, &number) ? absl::StrFormat("%.15g", number + 1) : "spoilt";
}

// Every key of a file exists, so none is documented in vain; that the documented file sets every
// option back shows that none is missing in it, and that it holds the defaults.
TEST(OptionsFile, TheDocumentedFileHoldsTheDefaultOfEveryOption) {
  const std::map<std::string, std::string> defaults = OptionValues(ServerOptions());
  EXPECT_GT(defaults.size(), 50u);
  std::map<std::string, std::string> sections;  // their text
  for (const auto& [key, value] : defaults) {
    const std::vector<std::string> names = absl::StrSplit(key, '.');
    ASSERT_LE(names.size(), 2u) << key;
    sections[names.size() == 2 ? names[0] : ""] +=
        absl::StrCat(names.size() == 2 ? "  " : "", names.back(), ": ", Spoilt(key, value), "\n");
  }
  std::string text;
  for (const auto& [section, lines] : sections) {
    absl::StrAppend(&text, section, section.empty() ? "" : ":\n", lines);
  }
  ServerOptions options;
  absl::Status status = Read(Write(text), options);
  ASSERT_TRUE(status.ok()) << status << "\n" << text;
  for (const auto& [key, value] : OptionValues(options)) EXPECT_NE(value, defaults.at(key)) << key;

  status = Read(std::string(OVERTONE_SOURCE_DIR) + "/services/mapping_server/configs/default.yaml",
                options);
  ASSERT_TRUE(status.ok()) << status;
  EXPECT_EQ(OptionValues(options), defaults);
}

// OptionValues must not be wrong in the same way as the file.
TEST(OptionsFile, ValuesAreThoseOfTheOptions) {
  ServerOptions options;
  options.limits.max_stored_blob_bytes = int64_t{3} << 40;
  options.publisher.tolerance.rotation_rad = 0.1;
  options.map.robust = MultiRobotMapOptions::Robust::kHuber;
  options.loop_closures.enabled = false;
  options.loop_closures.verifier.required.min_overlap = 0.25;
  const std::map<std::string, std::string> values = OptionValues(options);
  EXPECT_EQ(values.at("listen"), "localhost:7077");
  EXPECT_EQ(values.at("limits.max_stored_blob_bytes"), "3298534883328");
  EXPECT_EQ(values.at("publisher.rotation_tolerance_rad"), "0.1");
  EXPECT_EQ(values.at("map.robust"), "huber");
  EXPECT_EQ(values.at("loop_closures.enabled"), "false");
  EXPECT_EQ(values.at("loop_closures.min_overlap"), "0.25");
}

TEST(OptionsFile, MistakesAreNamedWithTheirLine) {
  const struct {
    std::string text;
    std::string message;
  } cases[] = {
      {"graph:\n  max_node: 5\n",
       ":2: unknown key 'graph.max_node'; did you mean 'graph.max_nodes'?"},
      {"lissten: a:1\n", ":1: unknown key 'lissten'; did you mean 'listen'?"},
      {"\nlimits:\n  max_maps: many\n", ":3: limits.max_maps has a value of the wrong type"},
      {"listen: [a, b]\n", ":1: listen has a value of the wrong type"},
      {"map:\n  robust: always\n", ":2: map.robust has a value of the wrong type"},
      {"{{a: b}: c}\n", ":1: a key is not a word"},
      {"listen: a:1\nlisten: b:2\n", ":2: listen is given twice"},
      {"graph: 3\n", ":1: unknown key 'graph'"},
      {"\nlisten: a: b\n", "options.yaml:2: "},
      {"- listen\n", ":1: not a mapping"},
  };
  for (const auto& bad : cases) {
    ServerOptions options;
    const absl::Status status = Read(Write(bad.text), options);
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << bad.text;
    EXPECT_THAT(std::string(status.message()), HasSubstr(bad.message));
  }
  ServerOptions options;
  EXPECT_EQ(Read("/nowhere.yaml", options).code(), absl::StatusCode::kNotFound);
  EXPECT_TRUE(Read(Write(""), options).ok());
}

TEST(OptionsFile, AllMistakesAreNamedAtOnceAndEachOptionHasItsLine) {
  ServerOptions options;
  OptionSources sources;
  const std::string path = Write(
      "lissten: a:1\nlimits:\n  max_maps: many\n  max_missions_per_map: 5\n"
      "data_dir:\n  here\n");
  const absl::Status status = ReadOptionsFile(path, options, sources);
  EXPECT_EQ(status.message(),
            absl::StrCat(path, ":1: unknown key 'lissten'; did you mean 'listen'?\n", path,
                         ":3: limits.max_maps has a value of the wrong type: not integer"));
  EXPECT_EQ(sources.size(), 2u);
  EXPECT_EQ(sources.at("limits.max_missions_per_map").place, path + ":4");
  EXPECT_EQ(sources.at("data_dir").place, path + ":6");

  std::string something_else;
  for (int i = 0; i < 1000; ++i) absl::StrAppend(&something_else, "key", i, ": 1\n");
  OptionSources none;
  EXPECT_LT(ReadOptionsFile(Write(something_else), options, none).message().size(), 4000u);
  EXPECT_TRUE(none.empty());
}

}  // namespace
}  // namespace overtone
