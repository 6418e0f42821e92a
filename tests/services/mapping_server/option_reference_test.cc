// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/option_reference.h"

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "absl/strings/str_split.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/services/mapping_server/default_configuration.h"
#include "overtone/services/mapping_server/option_table.h"

namespace overtone {
namespace {

using ::testing::HasSubstr;

std::string Contents(const std::string& path) {
  std::ifstream in(std::string(OVERTONE_SOURCE_DIR) + "/" + path);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

TEST(OptionReference, EveryOptionAndSectionHasATextOfItsOwn) {
  std::vector<std::string> documented;
  for (const OptionText& option : OptionTexts(DefaultConfiguration())) {
    EXPECT_GT(option.text.size(), 10u) << option.key << " needs a comment right above it";
    const bool section = ::testing::Matches(
        ::testing::Contains(::testing::StartsWith(option.key + ".")))(OptionKeys());
    if (!section) documented.push_back(option.key);
  }
  EXPECT_EQ(documented, OptionKeys()) << "default.yaml and option_table.cc have one order";
}

TEST(OptionReference, TextsAreTheCommentsRightAbove) {
  const auto texts = OptionTexts(
      "# The file.\n\n# One\n#   line.\na: 1\nb: 2\n# Of s.\ns:\n  # Of c: d.\n  c: \"x:y\"\n# "
      "E.\ne: 3\n");
  ASSERT_EQ(texts.size(), 5u);
  EXPECT_EQ(texts[0].text, "One line.");
  EXPECT_EQ(texts[1].text, "");
  EXPECT_EQ(texts[2].key, "s");
  EXPECT_EQ(texts[3].key, "s.c");
  EXPECT_EQ(texts[3].text, "Of c: d.");
  EXPECT_EQ(texts[4].key, "e");
}

TEST(OptionReference, KeysEndWithTheirUnit) {
  EXPECT_EQ(OptionUnit("keepalive_s"), "s");
  EXPECT_EQ(OptionUnit("quotas.max_bytes_per_s"), "bytes/s");
  EXPECT_EQ(OptionUnit("quotas.bytes_burst"), "bytes");
  EXPECT_EQ(OptionUnit("graph.radius_m"), "m");
  EXPECT_EQ(OptionUnit("limits.max_maps"), "");
  EXPECT_EQ(OptionUnit("map.num_threads"), "");
}

TEST(OptionReference, TheCommittedPageIsWhatIsGenerated) {
  EXPECT_EQ(Contents("docs/configuration.md"), ConfigurationReference())
      << "overtone-mapping-server config reference > docs/configuration.md";
  EXPECT_EQ(Contents("services/mapping_server/configs/default.yaml"), DefaultConfiguration());
}

TEST(OptionReference, AKeyASectionAVariableOrEverythingIsExplained) {
  const auto key = ExplainOption("quotas.max_streams");
  ASSERT_TRUE(key.ok()) << key.status();
  EXPECT_EQ(*key,
            "quotas.max_streams: integer; default 64; OVERTONE_QUOTAS_MAX_STREAMS\n"
            "  Uploads and watches open at once. A robot needs two, and one more for each mission "
            "that it still has something of.\n");
  EXPECT_EQ(*ExplainOption("OVERTONE_QUOTAS_MAX_STREAMS"), *key);
  EXPECT_THAT(*ExplainOption("keepalive_s"), HasSubstr("number, s; default 10; "));
  const auto section = ExplainOption("quotas");
  ASSERT_TRUE(section.ok()) << section.status();
  EXPECT_THAT(*section, HasSubstr(*key));
  EXPECT_THAT(*section, ::testing::Not(HasSubstr("listen")));
  EXPECT_GT(ExplainOption("")->size(), 4 * section->size());

  const absl::Status unknown = ExplainOption("quotas.burst_bytes_").status();
  EXPECT_EQ(unknown.code(), absl::StatusCode::kNotFound);
  EXPECT_THAT(std::string(ExplainOption("quotas.byte_burst").status().message()),
              HasSubstr("did you mean 'quotas.bytes_burst'?"));
}

}  // namespace
}  // namespace overtone
