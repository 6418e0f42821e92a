// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/place_recognition/scan_context_index.h"

#include <set>

#include "gtest/gtest.h"
#include "overtone/tests/core/place_recognition/synthetic_place.h"

namespace overtone {
namespace {

const ScanContextOptions kOptions;

ScanContext Seen(const PointCloud& cloud) {
  return ComputeScanContext(cloud, Eigen::Quaterniond::Identity(), kOptions);
}

bool Any(int) { return true; }

TEST(ScanContextIndex, FindsNothingInNothing) {
  ScanContextIndex index(kOptions);
  EXPECT_TRUE(index.Search(Seen(SyntheticPlace(1)), 5, Any).empty());
  index.Add(Seen(SyntheticPlace(1)));
  EXPECT_TRUE(index.Search(Seen({}), 5, Any).empty()) << "the query saw nothing";
  EXPECT_TRUE(index.Search(Seen(SyntheticPlace(1)), 5, [](int) { return false; }).empty());
}

TEST(ScanContextIndex, NumbersPlacesAndFindsThemTurned) {
  ScanContextIndex index(kOptions);
  for (int place = 0; place < 100; ++place) {
    EXPECT_EQ(index.Add(Seen(SyntheticPlace(place))), place);
  }
  EXPECT_EQ(index.size(), 100);
  for (int place = 0; place < 100; ++place) {
    const auto matches =
        index.Search(Seen(Turned(SyntheticPlace(place), Yaw(-1.0 + 0.02 * place))), 3, Any);
    ASSERT_EQ(matches.size(), 3u);
    EXPECT_EQ(matches[0].place, place);
    EXPECT_NEAR(matches[0].yaw_rad, -1.0 + 0.02 * place, 0.06);
    EXPECT_GT(matches[0].similarity, matches[1].similarity);
    EXPECT_GE(matches[1].similarity, matches[2].similarity);
  }
}

// Own recent keyframes, most of the index, are the most similar: they must not use up candidates.
TEST(ScanContextIndex, WhatMayNotMatchTakesNoRoom) {
  ScanContextIndex index(kOptions, /*candidates=*/5);
  for (int i = 0; i < 50; ++i) index.Add(Seen(SyntheticPlace(1)));
  const int other = index.Add(Seen(SyntheticPlace(2)));
  const auto matches =
      index.Search(Seen(SyntheticPlace(1)), 10, [other](int place) { return place >= other; });
  ASSERT_EQ(matches.size(), 1u);
  EXPECT_EQ(matches[0].place, other);
}

TEST(ScanContextIndex, ComparesNoMoreThanItsCandidates) {
  ScanContextIndex index(kOptions, /*candidates=*/7);
  for (int place = 0; place < 60; ++place) index.Add(Seen(SyntheticPlace(place)));
  const auto matches = index.Search(Seen(SyntheticPlace(3)), 1000, Any);
  EXPECT_EQ(matches.size(), 7u);
  std::set<int> places;
  for (const PlaceMatch& match : matches) places.insert(match.place);
  EXPECT_EQ(places.size(), 7u);
}

// Every place again, from another heading and with a fifth of the things changed.
TEST(ScanContextIndex, ReturnsWhatComparingWithAllReturnsForNearlyAllQueries) {
  constexpr int kPlaces = 1000;
  ScanContextIndex index(kOptions);
  ScanContextIndex exhaustive(kOptions, /*candidates=*/kPlaces);
  for (int place = 0; place < kPlaces; ++place) {
    index.Add(Seen(SyntheticPlace(place)));
    exhaustive.Add(Seen(SyntheticPlace(place)));
  }
  int same = 0;
  int queries = 0;
  for (int place = 0; place < kPlaces; place += 20, ++queries) {
    PointCloud cloud = SyntheticPlace(place);
    cloud.points.resize(cloud.points.size() * 4 / 5);
    const PointCloud changed = SyntheticPlace(place + kPlaces, 3 * M_PI / 5, M_PI);
    cloud.points.insert(cloud.points.end(), changed.points.begin(), changed.points.end());
    const ScanContext query = Seen(Turned(cloud, Yaw(place)));
    same += index.Search(query, 1, Any)[0].place == exhaustive.Search(query, 1, Any)[0].place;
  }
  std::printf("the same as of all %d places: %d of %d queries\n", kPlaces, same, queries);
  EXPECT_GE(same, 0.95 * queries);
}

}  // namespace
}  // namespace overtone
