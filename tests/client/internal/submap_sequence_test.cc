// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/internal/submap_sequence.h"

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/tests/support/straight_mission.h"

namespace overtone {
namespace {

TEST(SubmapSequence, AcceptsSubmapsThatFollowEachOther) {
  SubmapSequence sequence;
  for (int64_t i = 0; i < 5; ++i) {
    const Submap submap = StraightSubmap(i);
    ASSERT_TRUE(sequence.Check(submap).ok());
    sequence.Advance(submap);
  }
}

TEST(SubmapSequence, NamesAGapARepetitionAndAWrongIndex) {
  SubmapSequence sequence;
  EXPECT_EQ(sequence.Check(StraightSubmap(1)).code(), absl::StatusCode::kOutOfRange);
  sequence.Advance(StraightSubmap(0));
  EXPECT_EQ(sequence.Check(StraightSubmap(0)).code(), absl::StatusCode::kOutOfRange);
  Submap submap = StraightSubmap(1);
  submap.first_index = 11;
  const absl::Status status = sequence.Check(submap);
  EXPECT_EQ(status.code(), absl::StatusCode::kOutOfRange);
  EXPECT_THAT(std::string(status.message()),
              testing::StartsWith("first_index: expected 10, got 11"));
}

TEST(SubmapSequence, RefusesTimeThatStandsStillBetweenSubmaps) {
  SubmapSequence sequence;
  sequence.Advance(StraightSubmap(0));
  Submap submap = StraightSubmap(1);
  submap.keyframes[0].stamp = StraightSubmap(0).keyframes.back().stamp;
  const absl::Status status = sequence.Check(submap);
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(status.message()), testing::StartsWith("keyframes[0].stamp_ns"));
}

TEST(SubmapSequence, TakesARefusedSubmapAnew) {
  SubmapSequence sequence;
  for (int64_t i = 0; i < 3; ++i) sequence.Advance(StraightSubmap(i));
  sequence.MoveTo({1, 10});
  EXPECT_TRUE(sequence.Check(StraightSubmap(1)).ok());
  EXPECT_FALSE(sequence.Check(StraightSubmap(3)).ok());
}

}  // namespace
}  // namespace overtone
