// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/suggestion.h"

#include <algorithm>
#include <string>
#include <vector>

#include "gtest/gtest.h"

namespace overtone {
namespace {

TEST(Suggestion, EditDistanceCountsInsertionsDeletionsAndReplacements) {
  EXPECT_EQ(EditDistance("", "", 9), 0);
  EXPECT_EQ(EditDistance("", "abc", 9), 3);
  EXPECT_EQ(EditDistance("kitten", "sitting", 9), 3);  // Levenshtein's textbook pair
  EXPECT_EQ(EditDistance("sitting", "kitten", 9), 3);
  EXPECT_EQ(EditDistance("ab", "ba", 9), 2);
}

TEST(Suggestion, EditDistanceIsNeverAboveItsLimit) {
  for (int limit = 0; limit < 9; ++limit) {
    EXPECT_EQ(EditDistance("kitten", "sitting", limit), std::min(limit, 3)) << limit;
    EXPECT_EQ(EditDistance("abcdefgh", "xy", limit), std::min(limit, 8)) << limit;
    EXPECT_EQ(EditDistance("abcdefgh", "stuvwxyz", limit), std::min(limit, 8)) << limit;
  }
}

// A table of a million rows and columns would take minutes.
TEST(Suggestion, NamesOfVeryDifferentLengthsAreNotCompared) {
  const std::string longest(1'000'000, 'x');
  EXPECT_EQ(EditDistance(longest, longest.substr(1000), 1000), 1000);
  EXPECT_EQ(EditDistance(longest, std::string(longest.size(), 'y'), 10), 10);
}

TEST(Suggestion, TheNearestNameIsMeantAndNoneThatIsFarAway) {
  const std::vector<std::string> known = {"listen", "graph.max_nodes", "quotas.max_streams",
                                          "limits.max_maps"};
  const struct {
    std::string wanted, nearest;
  } cases[] = {
      {"lissten", "listen"},
      {"graph.max_node", "graph.max_nodes"},
      {"max_nodes", "graph.max_nodes"},              // without its section
      {"limits.max_streams", "quotas.max_streams"},  // in another one
      {"quota.max_stream", "quotas.max_streams"},
      {"dashboard", ""},
      // Its last part is short, and yet no other name's.
      {std::string(60, 'x') + ".yes", ""},
      {std::string(60, 'x') + ".max_map", "limits.max_maps"},
      {"", ""},
  };
  for (const auto& c : cases) EXPECT_EQ(NearestName(c.wanted, known), c.nearest) << c.wanted;
  EXPECT_EQ(DidYouMean("listen"), "; did you mean 'listen'?");
  EXPECT_EQ(DidYouMean(""), "");
  EXPECT_EQ(NearestName("x", {}), "");
  EXPECT_EQ(NearestName(std::string(1'000'000, 'x'), known), "");
}

// As in the environment, where words are joined by underscores only.
TEST(Suggestion, TheEndOfANameIsEnough) {
  EXPECT_EQ(NearestName("MAX_STREAMS", {"LISTEN", "QUOTAS_MAX_STREAMS"}), "QUOTAS_MAX_STREAMS");
  EXPECT_EQ(NearestName("REAMS", {"LISTEN", "QUOTAS_MAX_STREAMS"}), "");
}

}  // namespace
}  // namespace overtone
