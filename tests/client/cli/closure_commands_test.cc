// SPDX-License-Identifier: Apache-2.0
// The operators' commands, as typed, against a server in this process.
#include "overtone/client/cli/closure_commands.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/client/cli/admin_commands.h"
#include "overtone/tests/client/cli/command_outcome.h"
#include "overtone/tests/services/mapping_server/server_fixture.h"

namespace overtone {
namespace {

using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::MakeClosure;
using testing::MakeSubmap;
using ::testing::Not;
using testing::Outcome;
using testing::Uploader;

const MissionId kAnna = {"anna", "run1"};
const char kRight[] = "anna/run1:15>anna/run1:3#0";
const char kWrong[] = "anna/run1:18>anna/run1:0#0";

TEST(ParseIds, WhatTheCommandsPrintReadsBack) {
  const MissionId mission = {"anna-2", "run_1"};
  const auto read_mission = ParseMissionId(ToString(mission));
  ASSERT_TRUE(read_mission.ok()) << read_mission.status();
  EXPECT_EQ(*read_mission, mission);
  for (const int64_t index : {int64_t{0}, int64_t{12}, int64_t{1} << 40}) {
    const NodeId node = {mission, index};
    const auto read = ParseNodeId(ToString(node));
    ASSERT_TRUE(read.ok()) << read.status();
    EXPECT_EQ(*read, node);
  }
}

TEST(ParseIds, WhatIsNoIdIsRefusedWithWhatWasExpected) {
  for (const char* text :
       {"", "anna", "anna/", "/run1", "anna/run1/2", "Anna/run1", "anna/run 1", "anna/run1:3"}) {
    const auto mission = ParseMissionId(text);
    EXPECT_EQ(mission.status().code(), absl::StatusCode::kInvalidArgument) << text;
    EXPECT_EQ(mission.status().message(), absl::StrCat("\"", text, "\": expected robot/mission"));
  }
  for (const char* text :
       {"", "anna/run1", "anna/run1:", "anna/run1:-1", "anna/run1:x", "anna/run1:1:2",
        "anna/run1:1.5", "anna:3", ":3", "anna/run1:99999999999999999999"}) {
    const auto node = ParseNodeId(text);
    EXPECT_EQ(node.status().code(), absl::StatusCode::kInvalidArgument) << text;
    EXPECT_EQ(node.status().message(),
              absl::StrCat("\"", text, "\": expected robot/mission:index"));
  }
}

class ClosureCommandsTest : public testing::ServerTest {
 protected:
  void SetUp() override {
    StartServer();
    Submap submap = MakeSubmap(0, 0, 20);
    LoopClosure right = MakeClosure({kAnna, 15}, {kAnna, 3});
    right.from_tform_to =
        submap.keyframes[15].mission_from_body.Inverse() * submap.keyframes[3].mission_from_body;
    submap.loop_closures = {right, MakeClosure({kAnna, 18}, {kAnna, 0})};
    submap.candidates = {{{kAnna, 16}, {kAnna, 1}, 0.3}};
    Uploader uploader(*mapping_, "mine", kAnna);
    ASSERT_TRUE(uploader.Read().has_ready());
    ASSERT_TRUE(uploader.Send(submap).has_ack());
    EXPECT_TRUE(uploader.Close().ok());
    Settle("mine");
  }

  Outcome RunAt(const std::string& server, std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--server", server});
    return testing::RunCommand({AddAdminCommands, AddClosureCommands}, std::move(arguments));
  }
  // On the map "mine".
  Outcome Run(std::vector<std::string> arguments) {
    if (arguments[0] != "status") arguments.insert(arguments.end(), {"--map", "mine"});
    return RunAt(server_->address(), arguments);
  }
  std::string OutputOf(const std::vector<std::string>& arguments) {
    const Outcome outcome = Run(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.err, IsEmpty());
    return outcome.out;
  }
};

TEST_F(ClosureCommandsTest, ClosuresAreATableWithVerdictAndWhy) {
  const std::string table = OutputOf({"closures"});
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 1 + 3) << table;
  EXPECT_THAT(table,
              AllOf(ContainsRegex(absl::StrCat(kRight, ".* robot .* accepted .*fits the map")),
                    ContainsRegex(absl::StrCat(kWrong, ".* rejected_inconsistent .*odometry")),
                    ContainsRegex("robot_score .* 0.30 .* rejected_score .*below 0.50")));
}

TEST_F(ClosureCommandsTest, FiltersNarrowTheTable) {
  const auto rows = [&](std::vector<std::string> filter) {
    filter.insert(filter.begin(), {"closures", "--json"});
    const std::string lines = OutputOf(filter);
    return std::count(lines.begin(), lines.end(), '\n');
  };
  EXPECT_EQ(rows({}), 3);
  EXPECT_EQ(rows({"--verdict", "accepted"}), 1);
  EXPECT_EQ(rows({"--verdict", "vetoed_by_operator"}), 0);
  EXPECT_EQ(rows({"--proposer", "robot"}), 2);
  EXPECT_EQ(rows({"--robot", "bert"}), 0);
  EXPECT_EQ(rows({"--mission", "anna/run1", "--proposer", "robot_score"}), 1);
}

TEST_F(ClosureCommandsTest, AnUnknownNameIsRefusedWithTheKnownOnes) {
  Outcome outcome = Run({"closures", "--verdict", "fine"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(outcome.err,
            "overtone closures: --verdict: \"fine\" is none of pending, accepted, "
            "demoted_by_optimiser, quarantined, rejected_score, rejected_overlap, "
            "rejected_residual, rejected_degenerate, rejected_inconsistent, vetoed_by_operator, "
            "forced_by_operator\n");
  EXPECT_THAT(outcome.out, IsEmpty());
  outcome = Run({"closures", "--proposer", "unspecified"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err,
              HasSubstr("--proposer: \"unspecified\" is none of robot, robot_score, scan_context"));
}

TEST_F(ClosureCommandsTest, NearAPlaceTheAnswerIsASentence) {
  std::string text = OutputOf({"closures", "--near", "anna/run1:15", "--radius", "0.2"});
  EXPECT_THAT(text, AllOf(HasSubstr("There is 1 loop closure in use within 0.2 m"),
                          HasSubstr(kRight), Not(HasSubstr(kWrong))));
  text = OutputOf({"closures", "--near", "anna/run1:8", "--radius", "1"});
  EXPECT_THAT(text, HasSubstr("There is no loop within 1 m of anna/run1:8 because nothing was"));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1);
  EXPECT_THAT(OutputOf({"closures", "--near", "anna/run1:8", "--json"}),
              HasSubstr("\"explanation\":\"There"));
  const Outcome outcome = Run({"closures", "--near", "anna/run1:20"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("anna/run1 has keyframes 0 to 19"));
  EXPECT_EQ(Run({"closures", "--near", "anna"}).exit_code, 2);
}

TEST_F(ClosureCommandsTest, ForcedVetoedAndRolledBackTheMapFollows) {
  const std::string before = std::to_string(Settle("mine").revision());
  EXPECT_THAT(OutputOf({"status"}), ContainsRegex(absl::StrCat("mine +", before, " .* 1/3 ")));
  EXPECT_EQ(OutputOf({"force", kWrong}),
            absl::StrCat("forced ", kWrong, "; the next revision holds the result\n"));
  Settle("mine");
  // Now the right one contradicts the map.
  EXPECT_THAT(OutputOf({"closures", "--verdict", "demoted_by_optimiser"}), HasSubstr(kRight));
  EXPECT_THAT(OutputOf({"closures", "--verdict", "forced_by_operator"}), HasSubstr(kWrong));
  // Revision by revision, newest first.
  EXPECT_THAT(OutputOf({"revisions"}),
              ContainsRegex(
                  absl::StrCat("^revision [^\n]*\n[0-9]+ [^\n]* 1/1 [^\n]* 1 forced_by_operator\n",
                               before, " [^\n]* 1 accepted")));

  EXPECT_THAT(OutputOf({"rollback", before}),
              HasSubstr(absl::StrCat("vetoed 1 loop closures that came into use after revision ",
                                     before, "; the map goes on in epoch ")));
  Settle("mine");
  EXPECT_THAT(OutputOf({"closures", "--verdict", "vetoed_by_operator"}), HasSubstr(kWrong));
  EXPECT_EQ(OutputOf({"veto", kRight, "--json"}),
            absl::StrCat("{\"decision\":\"vetoed\",\"id\":\"", kRight, "\"}\n"));
  EXPECT_EQ(OutputOf({"veto", kRight, kWrong}),
            absl::StrCat("vetoed ", kRight, "; the next revision holds the result\nvetoed ", kWrong,
                         "; the next revision holds the result\n"));
  Settle("mine");
  EXPECT_THAT(OutputOf({"status"}), ContainsRegex("mine .* 0/3 "));
  EXPECT_THAT(OutputOf({"status", "--json"}), HasSubstr("\"loop_closures\":\"3\""));
}

TEST_F(ClosureCommandsTest, WhatDoesNotExistIsSaidOnStandardError) {
  Outcome outcome = Run({"veto", kRight, "anna/run1:1>anna/run1:0#0", kWrong});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.out, AllOf(HasSubstr(kRight), Not(HasSubstr(kWrong))));
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("overtone veto: "),
                                 HasSubstr("no loop closure \"anna/run1:1>anna/run1:0#0\"")));
  EXPECT_THAT(Run({"rollback", "77"}).err, HasSubstr("77 is not among those kept"));
  outcome = RunAt(server_->address(), {"revisions", "--map", "nowhere"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("nowhere"));
  outcome = RunAt("localhost:1", {"status", "--timeout", "2"});
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.err, HasSubstr("localhost:1"));
}

}  // namespace
}  // namespace overtone
