// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/watch.h"

#include <algorithm>
#include <string>
#include <vector>

#include "absl/strings/str_split.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "nlohmann/json.hpp"

namespace overtone {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

const absl::Time kNow = absl::FromUnixSeconds(1'700'000'000);  // 22:13:20 UTC

std::vector<WatchedMap> Town(uint64_t revision) {
  WatchedMap map;
  map.summary.set_map("town");
  map.summary.set_revision(revision);
  map.summary.set_keyframes(120);
  v1::VerdictCount& count = *map.summary.add_verdicts();
  count.set_verdict(v1::LOOP_CLOSURE_VERDICT_ACCEPTED);
  count.set_count(17);
  for (const char* name : {"anna", "bert"}) {
    map.robots.emplace_back().set_robot(name);
  }
  return {map};
}

TEST(ChangeLog, OnlyWhatHasChangedIsSaid) {
  ChangeLog log(/*json=*/false);
  std::string lines = log.Changes(Town(1), kNow);
  EXPECT_EQ(std::count(lines.begin(), lines.end(), '\n'), 3) << lines;
  EXPECT_THAT(lines, StartsWith("22:13:20 town: revision 1 of "));
  EXPECT_THAT(lines, HasSubstr("closures: 17 accepted"));
  EXPECT_THAT(log.Changes(Town(1), kNow), IsEmpty());
  EXPECT_THAT(log.Changes(Town(2), kNow), StartsWith("22:13:20 town: revision 2 "));
  std::vector<WatchedMap> maps = Town(2);
  maps[0].robots[1].set_bytes_received(77);  // no news
  EXPECT_THAT(log.Changes(maps, kNow), IsEmpty());
  maps[0].robots[1].set_uploading(true);
  EXPECT_THAT(log.Changes(maps, kNow), StartsWith("22:13:20 town/bert: up, "));
}

TEST(ChangeLog, ALossIsSaidOnceAndSoIsTheReturn) {
  ChangeLog log(/*json=*/false);
  log.Changes(Town(1), kNow);
  const absl::Status lost = absl::UnavailableError("server x: cannot be reached");
  EXPECT_EQ(log.Lost(lost, kNow),
            "22:13:20 server: lost, trying again: server x: cannot be reached\n");
  EXPECT_EQ(log.Lost(lost, kNow), "");
  EXPECT_EQ(log.Changes(Town(1), kNow), "22:13:20 server: is back\n");
  EXPECT_THAT(log.Lost(lost, kNow), HasSubstr("lost, trying again"));
}

TEST(ChangeLog, JsonLinesAreObjectsWithTheMessagesInThem) {
  ChangeLog log(/*json=*/true);
  std::string text = log.Changes(Town(3), kNow);
  text += log.Lost(absl::UnavailableError("a \"quoted\"\nreason"), kNow);
  std::vector<nlohmann::json> objects;
  for (const absl::string_view line : absl::StrSplit(text, '\n', absl::SkipEmpty())) {
    objects.push_back(nlohmann::json::parse(line));
    EXPECT_EQ(objects.back().at("time"), "2023-11-14T22:13:20+00:00");
  }
  ASSERT_EQ(objects.size(), 4u);
  EXPECT_EQ(objects[0].at("map"), "town");
  EXPECT_EQ(objects[0].at("summary").at("revision"), "3");  // protobuf's JSON of 64 bits
  EXPECT_EQ(objects[1].at("robot").at("robot"), "anna");
  EXPECT_EQ(objects[3].at("error"), "a \"quoted\"\nreason");
}

TEST(Picture, ATerminalThatIsTooLowIsToldHowMuchIsMissing) {
  const std::string all = Picture(Town(1), 0);
  EXPECT_EQ(std::count(all.begin(), all.end(), '\n'), 4) << all;  // map, header, two robots
  EXPECT_EQ(Picture(Town(1), 4), all);
  const std::string some = Picture(Town(1), 3);
  EXPECT_EQ(std::count(some.begin(), some.end(), '\n'), 3) << some;
  EXPECT_THAT(some, HasSubstr("(2 more lines; --map shows one map)\n"));
  EXPECT_THAT(Picture({}, 0), StartsWith("no map yet"));
}

}  // namespace
}  // namespace overtone
