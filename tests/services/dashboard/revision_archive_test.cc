// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/dashboard/revision_archive.h"

#include <memory>

#include "gtest/gtest.h"
#include "overtone/services/dashboard/byte_rates.h"
#include "overtone/tests/services/dashboard/decoded_frame.h"

namespace overtone {
namespace {

// One mission of `nodes` positions.
MapView View(uint64_t revision, int nodes, uint64_t epoch = 1) {
  auto track = std::make_shared<Track>();
  for (int i = 0; i < nodes; ++i) {
    track->index.push_back(i);
    track->values.insert(track->values.end(), 3, static_cast<float>(i));
  }
  MapView view;
  view.summary.set_map_epoch(epoch);
  view.summary.set_revision(revision);
  view.missions.emplace_back();
  view.missions[0].number = 5;
  view.missions[0].positions.track = track;
  return view;
}

TEST(RevisionArchive, KeepsEachRevisionOnceAndThinned) {
  RevisionArchive history(1 << 20, 10);
  history.Add(View(0, 100));  // nothing yet
  history.Add(View(1, 100));
  history.Add(View(1, 100));
  history.Add(View(1, 100, 2));
  ASSERT_EQ(history.List().size(), 2u);
  EXPECT_EQ(history.List()[0].map_epoch, 1u);
  EXPECT_EQ(history.List()[1].map_epoch, 2u);
  const testing::DecodedFrame frame(*history.Frame(1, 1));
  EXPECT_EQ(frame.tracks.at(5).index.size(), 11u);  // every tenth and the last
  EXPECT_EQ(history.Frame(1, 2), nullptr);
}

TEST(RevisionArchive, WhenFullItForgetsEverySecondOfTheOlderHalfAndNeitherTheFirstNorTheNewest) {
  constexpr int kRevisions = 1000;
  const size_t bytes_each = 40 + 8 + 16 * 10;
  RevisionArchive history(20 * bytes_each, 10);
  for (int i = 1; i <= kRevisions; ++i) {
    history.Add(View(i, 10));
    ASSERT_NE(history.Frame(1, i), nullptr);
    ASSERT_LE(history.List().size(), 20u);
  }
  const auto seen = history.List();
  EXPECT_GE(seen.size(), 10u);
  for (size_t i = 1; i < seen.size(); ++i) EXPECT_GT(seen[i].revision, seen[i - 1].revision);
  EXPECT_EQ(seen.back().revision, uint64_t{kRevisions});
  EXPECT_EQ(seen.front().revision, 1u);
}

TEST(ByteRates, AreOfTheWindowAndStartAnewWithTheCounter) {
  ByteRates rates(absl::Seconds(5));
  const absl::Time start = absl::FromUnixSeconds(1000);
  EXPECT_EQ(rates.Add("anna", start, 1'000'000), 0);
  EXPECT_EQ(rates.Add("anna", start + absl::Seconds(1), 1'000'500), 500);
  for (int i = 2; i <= 20; ++i) rates.Add("anna", start + absl::Seconds(i), 1'000'500);
  EXPECT_EQ(rates.Add("anna", start + absl::Seconds(21), 1'000'500), 0);  // the burst is long over
  EXPECT_EQ(rates.Add("anna", start + absl::Seconds(22), 40), 0);         // the server restarted
  EXPECT_EQ(rates.Add("anna", start + absl::Seconds(24), 240), 100);
  EXPECT_EQ(rates.Add("bert", start + absl::Seconds(24), 240), 0);
}

}  // namespace
}  // namespace overtone
