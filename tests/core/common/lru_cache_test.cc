// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/common/lru_cache.h"

#include <string>

#include "gtest/gtest.h"

namespace overtone {
namespace {

std::shared_ptr<const int> Value(int value) { return std::make_shared<const int>(value); }

TEST(LruCache, FindsWhatWasInsertedAndNothingElse) {
  LruCache<std::string, int> cache(2);
  EXPECT_EQ(cache.Find("a"), nullptr);
  const auto value = Value(1);
  cache.Insert("a", value);
  EXPECT_EQ(cache.Find("a"), value);
  EXPECT_EQ(cache.Find("b"), nullptr);
  EXPECT_EQ(cache.size(), 1u);
}

TEST(LruCache, TheOldestGoesWhenItIsFull) {
  LruCache<int, int> cache(2);
  for (const int key : {1, 2, 3}) cache.Insert(key, Value(10 * key));
  EXPECT_EQ(cache.size(), 2u);
  EXPECT_EQ(cache.Find(1), nullptr);
  EXPECT_EQ(*cache.Find(2), 20);
  EXPECT_EQ(*cache.Find(3), 30);
}

TEST(LruCache, WhatIsAskedForStaysAheadOfWhatIsNewer) {
  LruCache<int, int> cache(2);
  cache.Insert(1, Value(10));
  cache.Insert(2, Value(20));
  cache.Find(1);
  cache.Insert(3, Value(30));
  EXPECT_EQ(cache.Find(2), nullptr);
  EXPECT_NE(cache.Find(1), nullptr);
}

TEST(LruCache, InsertingAgainReplacesTheValueAndMakesItTheNewest) {
  LruCache<int, int> cache(2);
  cache.Insert(1, Value(10));
  cache.Insert(2, Value(20));
  cache.Insert(1, Value(11));
  EXPECT_EQ(cache.size(), 2u);
  cache.Insert(3, Value(30));
  EXPECT_EQ(*cache.Find(1), 11);
  EXPECT_EQ(cache.Find(2), nullptr);
}

TEST(LruCache, ErasingMakesRoom) {
  LruCache<int, int> cache(2);
  cache.Insert(1, Value(10));
  cache.Insert(2, Value(20));
  cache.Erase(2);
  cache.Erase(7);
  EXPECT_EQ(cache.Find(2), nullptr);
  cache.Insert(3, Value(30));
  EXPECT_EQ(*cache.Find(1), 10);
  EXPECT_EQ(cache.size(), 2u);
}

TEST(LruCache, WithoutCapacityNothingIsKept) {
  LruCache<int, int> cache(0);
  cache.Insert(1, Value(10));
  EXPECT_EQ(cache.Find(1), nullptr);
  EXPECT_EQ(cache.size(), 0u);
}

TEST(LruCache, AValueOutlivesItsPlaceInTheCache) {
  LruCache<int, int> cache(1);
  cache.Insert(1, Value(10));
  const auto held = cache.Find(1);
  cache.Insert(2, Value(20));
  EXPECT_EQ(*held, 10);
}

}  // namespace
}  // namespace overtone
