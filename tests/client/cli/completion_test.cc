// SPDX-License-Identifier: Apache-2.0
// The bash script, run by bash.
#include "overtone/client/cli/completion.h"

#include <cstdio>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/client/cli/admin_commands.h"
#include "overtone/client/cli/certs_command.h"
#include "overtone/client/cli/closure_commands.h"
#include "overtone/client/cli/completion_command.h"
#include "overtone/client/cli/evaluate_command.h"
#include "overtone/client/cli/export_command.h"
#include "overtone/client/cli/health_command.h"
#include "overtone/client/cli/import_command.h"
#include "overtone/client/cli/maintenance_commands.h"
#include "overtone/client/cli/replay_command.h"
#include "overtone/client/cli/report_command.h"
#include "overtone/client/cli/robot_command.h"
#include "overtone/client/cli/simulate_command.h"
#include "overtone/client/cli/watch_command.h"
#include "overtone/tests/support/temporary_directory.h"

namespace overtone {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::UnorderedElementsAre;

class CompletionTest : public ::testing::Test {
 protected:
  CompletionTest() {
    app_.set_help_flag("-h,--help", "Print help");
    for (const auto add :
         {AddAdminCommands, AddCertsCommand, AddClosureCommands, AddCompletionCommand,
          AddEvaluateCommand, AddExportCommand, AddHealthCommand, AddImportCommand,
          AddMaintenanceCommands, AddReplayCommand, AddReportCommand, AddRobotCommand,
          AddSimulateCommand, AddWatchCommand}) {
      add(&app_, &run_);
    }
    CLI::App* config = app_.add_subcommand("config", "Options of the server");
    config->add_subcommand("check", "Look for mistakes")->add_flag("--strict", "Warnings, too");
    config->add_subcommand("explain", "Say what is in force");
    std::ofstream(folder_.File("overtone.bash")) << BashCompletion(Describe(app_), "overtone");
  }

  // What bash offers for the last of the words, cut as readline cuts them.
  std::vector<std::string> Complete(const std::vector<std::string>& words) {
    std::string quoted;
    for (const std::string& word : words) absl::StrAppend(&quoted, " '", word, "'");
    std::ofstream(folder_.File("run.bash"))
        << "set -u\ncd " << folder_.path() << "\nsource overtone.bash\nCOMP_WORDS=(" << quoted
        << ")\nCOMP_CWORD=" << words.size() - 1
        << "\n_overtone\nprintf '%s\\n' ${COMPREPLY[@]+\"${COMPREPLY[@]}\"}\n"
        << "complete -p overtone >&2\n";
    FILE* pipe = popen(
        absl::StrCat("bash ", folder_.File("run.bash"), " 2> ", folder_.File("stderr")).c_str(),
        "r");
    std::string out;
    for (int c = 0; pipe != nullptr && (c = std::fgetc(pipe)) != EOF;) out += static_cast<char>(c);
    EXPECT_EQ(pclose(pipe), 0) << absl::StrJoin(words, " ");
    return absl::StrSplit(out, '\n', absl::SkipEmpty());
  }

  TemporaryDirectory folder_;
  CLI::App app_{"Overtone", "overtone"};
  std::function<int()> run_;
};

TEST_F(CompletionTest, CommandsAreCompletedAtAnyDepth) {
  EXPECT_THAT(Complete({"overtone", "st"}), ElementsAre("status"));
  EXPECT_THAT(Complete({"overtone", "rep"}), UnorderedElementsAre("report", "replay"));
  EXPECT_THAT(Complete({"overtone", ""}), AllOf(Contains("export"), Contains("--help")));
  EXPECT_THAT(Complete({"overtone", "config", ""}), AllOf(Contains("check"), Contains("explain")));
  EXPECT_THAT(Complete({"overtone", "config", "check", "--s"}), ElementsAre("--strict"));
  EXPECT_THAT(Complete({"overtone", "completion", "b"}), ElementsAre("bash"));
}

TEST_F(CompletionTest, FlagsAreThoseOfTheCommand) {
  EXPECT_THAT(Complete({"overtone", "export", "--fo"}), ElementsAre("--format"));
  EXPECT_THAT(Complete({"overtone", "status", "--"}),
              AllOf(Contains("--server"), Contains("--json"), Not(Contains("--format"))));
  // A value that is called like a command is none.
  EXPECT_THAT(Complete({"overtone", "export", "--map", "status", "--vo"}), ElementsAre("--voxel"));
}

TEST_F(CompletionTest, ValuesAreCompletedWhereTheyAreKnown) {
  EXPECT_THAT(Complete({"overtone", "export", "--format", ""}),
              UnorderedElementsAre("tum", "kitti", "euroc", "g2o", "ply"));
  EXPECT_THAT(Complete({"overtone", "export", "--format", "k"}), ElementsAre("kitti"));
  // As readline cuts --format=k.
  EXPECT_THAT(Complete({"overtone", "export", "--format", "=", "k"}), ElementsAre("kitti"));
  EXPECT_THAT(Complete({"overtone", "export", "--format", "="}), testing::SizeIs(5));
  EXPECT_THAT(Complete({"overtone", "export", "--map", ""}), IsEmpty());
  std::ofstream(folder_.File("town.tum")) << "x";
  EXPECT_THAT(Complete({"overtone", "export", "--out", "tow"}), ElementsAre("town.tum"));
  EXPECT_THAT(Complete({"overtone", "restore", "tow"}), ElementsAre("town.tum"));
}

// Every command and flag that --help knows.
TEST_F(CompletionTest, NothingIsMissing) {
  int commands = 0;
  for (const CLI::App* command : app_.get_subcommands([](const CLI::App*) { return true; })) {
    ++commands;
    const std::vector<std::string> offered = Complete({"overtone", command->get_name(), "--"});
    for (const CLI::Option* option : command->get_options()) {
      for (const std::string& name : option->get_lnames()) {
        EXPECT_THAT(offered, Contains("--" + name)) << command->get_name();
      }
    }
  }
  EXPECT_GE(commands, 10);
}

TEST_F(CompletionTest, EveryCommandHasAnExampleInItsHelp) {
  for (const CLI::App* command : app_.get_subcommands([](const CLI::App*) { return true; })) {
    if (command->get_name() == "config") continue;  // of this test
    EXPECT_THAT(command->get_footer(), ::testing::HasSubstr("overtone " + command->get_name()));
  }
}

TEST_F(CompletionTest, QuotesInDescriptionsDoNotEndTheScripts) {
  CLI::App app("Overtone", "overtone");
  app.add_subcommand("odd", "It's [a] test: `x` $y")->add_flag("--flag", "Don't: [really]");
  const CompletedCommand root = Describe(app);
  EXPECT_THAT(ZshCompletion(root, "overtone"),
              testing::HasSubstr("'*--flag[Don'\\''t\\: \\[really\\]]'"));
  EXPECT_THAT(FishCompletion(root, "overtone"),
              testing::HasSubstr("-l flag -d 'Don'\\''t: [really]'"));
}

}  // namespace
}  // namespace overtone
