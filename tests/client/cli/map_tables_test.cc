// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/map_tables.h"

#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace overtone {
namespace {

using ::testing::ElementsAre;

TEST(MapTables, ARobotThatReportedNothingHasQuestionMarks) {
  v1::Robot robot;
  robot.set_robot("anna");
  robot.set_missions(2);
  robot.set_keyframes(120);
  robot.set_uploading(true);
  robot.mutable_last_upload()->set_seconds(1'700'000'000);
  robot.set_bytes_received(1'234'567);
  robot.set_bytes_sent(999);
  const TableRows rows = RobotRows({robot});
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].size(), rows[1].size());
  EXPECT_THAT(rows[1], ElementsAre("anna", "up", "2", "120", "22:13:20", "?", "1.2 MB", "999 B",
                                   "-", "?", "?"));
}

TEST(MapTables, WhatARobotReportedIsSaidInWords) {
  v1::Robot robot;
  robot.set_uploading(true);
  robot.set_watching(true);
  v1::LinkReport& link = *robot.mutable_report()->mutable_link();
  EXPECT_EQ(LinkText(robot), "up and down");
  EXPECT_EQ(BacklogText(robot), "nothing");
  EXPECT_EQ(ComparisonText(robot), "none");
  link.set_submaps_waiting(1);
  link.set_blobs_waiting(2);
  link.set_bytes_waiting(45'600);
  EXPECT_EQ(BacklogText(robot), "1 submap, 2 clouds, 45.6 kB");
  link.mutable_clock_offset()->set_nanos(-12'400'000);
  EXPECT_EQ(ClockText(robot), "-12 ms");
  link.mutable_clock_offset()->set_seconds(-1);
  link.mutable_clock_offset_uncertainty()->set_nanos(2'100'000);
  EXPECT_EQ(ClockText(robot), "-1012 ms (within 3 ms)");

  v1::ComparisonReport& comparison = *robot.mutable_report()->mutable_comparison();
  comparison.set_revision(12);
  EXPECT_EQ(ComparisonText(robot), "revision 12: agrees");
  comparison.add_constraints()->set_added(2);
  comparison.add_constraints()->set_added(1);
  comparison.set_updated(4);
  comparison.set_rmse_before_m(0.214);
  comparison.set_predicted_rmse_m(0.05);
  EXPECT_EQ(ComparisonText(robot),
            "revision 12: 3 constraints, 4 updated, 0.21 to 0.05 m, not applied");
  comparison.set_applied(true);
  EXPECT_EQ(ComparisonText(robot), "revision 12: 3 constraints, 4 updated, 0.21 to 0.05 m");
  comparison.set_held_back("it would make things worse");
  EXPECT_EQ(ComparisonText(robot), "revision 12: it would make things worse");
}

TEST(MapTables, LinksAreNamedByTheStreamsThatAreOpen) {
  v1::Robot robot;
  EXPECT_EQ(LinkText(robot), "away");
  robot.set_watching(true);
  EXPECT_EQ(LinkText(robot), "down");
}

}  // namespace
}  // namespace overtone
