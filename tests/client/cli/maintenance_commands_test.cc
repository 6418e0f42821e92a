// SPDX-License-Identifier: Apache-2.0
// `overtone backup`, `restore`, `verify` and `delete`, as typed, against a server in this process.
#include "overtone/client/cli/maintenance_commands.h"

#include <fcntl.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "nlohmann/json.hpp"
#include "overtone/core/storage/sqlite_database.h"
#include "overtone/tests/client/cli/command_outcome.h"
#include "overtone/tests/services/mapping_server/maintenance_fixture.h"

namespace overtone {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::Outcome;
using ::testing::StartsWith;

const MissionId kAnna = {"anna", "run1"};
const MissionId kBert = {"bert", "run1"};

TEST(ConfirmDeletion, OnlyYesIsYes) {
  for (const char* yes : {"y\n", "Y\n", "yes\n"}) {
    std::istringstream in(yes);
    std::ostringstream out;
    EXPECT_TRUE(ConfirmDeletion("map mine", &in, &out).ok()) << yes;
    EXPECT_EQ(out.str(), "Delete map mine and all that is stored of it? [y/N] ");
  }
  for (const char* no : {"", "\n", "n\n", "yesterday\n", "mine\n"}) {
    std::istringstream in(no);
    std::ostringstream out;
    EXPECT_EQ(ConfirmDeletion("map mine", &in, &out).code(), absl::StatusCode::kCancelled) << no;
  }
}

class MaintenanceCommandsTest : public testing::MaintenanceTest {
 protected:
  void SetUp() override {
    MaintenanceTest::SetUp();
    // As a script has it, also when the test is run by hand.
    const int nothing = open("/dev/null", O_RDONLY);
    ASSERT_EQ(dup2(nothing, STDIN_FILENO), STDIN_FILENO);
    close(nothing);
    UploadWithClouds("mine", kAnna, 1);
    Upload("mine", kBert, 1, 7);
  }

  Outcome Run(std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--server", server_->address()});
    return testing::RunCommand({AddMaintenanceCommands}, std::move(arguments));
  }
  std::string OutputOf(const std::vector<std::string>& arguments) {
    const Outcome outcome = Run(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.err, IsEmpty());
    return outcome.out;
  }
  static std::string Read(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  }

  const std::string file_ = folder_.File("mine.backup");
};

TEST_F(MaintenanceCommandsTest, ABackupIsWrittenWholeAndMeasured) {
  const std::string out = OutputOf({"backup", "--map", "mine", "--output", file_});
  const std::string bytes = Read(file_);
  EXPECT_EQ(out, absl::StrCat("map mine: ", bytes.size(), " bytes in ", file_, ", SHA-256 ",
                              absl::BytesToHexString(Sha256(bytes)), "\n"));
  EXPECT_FALSE(std::filesystem::exists(file_ + ".part"));
  // Another time it takes the place of the first.
  const auto json =
      nlohmann::json::parse(OutputOf({"backup", "--map", "mine", "--output", file_, "--json"}));
  EXPECT_EQ(json.at("map"), "mine");
  EXPECT_EQ(json.at("file"), file_);
  EXPECT_EQ(json.at("bytes"), std::filesystem::file_size(file_));
  EXPECT_EQ(json.at("sha256"), absl::BytesToHexString(Sha256(Read(file_))));
}

TEST_F(MaintenanceCommandsTest, ABackupThatFailsLeavesTheFormerOne) {
  std::ofstream(file_) << "the former";
  const Outcome outcome = Run({"backup", "--map", "nowhere", "--output", file_});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, AllOf(StartsWith("overtone backup: "), HasSubstr("nowhere")));
  EXPECT_EQ(Read(file_), "the former");
  EXPECT_FALSE(std::filesystem::exists(file_ + ".part"));
  EXPECT_EQ(Run({"backup", "--map", "mine", "--output", "/nowhere/x"}).exit_code, 1);
}

TEST_F(MaintenanceCommandsTest, RestoringSaysWhatIsInAndReplacesOnlyWhenTold) {
  OutputOf({"backup", "--map", "mine", "--output", file_});
  EXPECT_THAT(OutputOf({"restore", "--map", "copy", file_}),
              AllOf(StartsWith(absl::StrCat("map copy restored from ", file_,
                                            ": 2 missions, 2 submaps, 5 clouds, ")),
                    HasSubstr("; it goes on in epoch ")));
  const Outcome outcome = Run({"restore", "--map", "copy", file_});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("there is a 'copy' already"),
                                 HasSubstr("--replace puts the backup in its place")));
  EXPECT_THAT(OutputOf({"restore", "--map", "copy", file_, "--replace", "--json"}),
              AllOf(HasSubstr("\"map_epoch\":"), HasSubstr("\"submaps\":\"2\"")));
  EXPECT_THAT(Maps(), ElementsAre("copy", "mine"));
}

TEST_F(MaintenanceCommandsTest, WhatIsNoBackupIsRefused) {
  Outcome outcome = Run({"restore", "--map", "copy", folder_.File("nothing")});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("nothing: there is no such file"));
  std::ofstream(file_) << "";
  EXPECT_THAT(Run({"restore", "--map", "copy", file_}).err, HasSubstr("is empty"));
  std::ofstream(file_) << std::string(1 << 20, 'x');
  outcome = Run({"restore", "--map", "copy", file_});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("the file is no backup that can be restored"));
  EXPECT_THAT(Maps(), ElementsAre("mine"));
}

TEST_F(MaintenanceCommandsTest, VerifyFailsWhenSomethingIsLostAndSaysWhat) {
  EXPECT_THAT(OutputOf({"verify", "--map", "mine"}),
              AllOf(StartsWith("map mine: 2 missions, 2 submaps, 5 clouds, "),
                    HasSubstr(" bytes on disk; all is whole\n")));
  {
    const auto database = SqliteDatabase::Open(StorePath("mine"), SqliteDatabase::Mode::kReadWrite);
    ASSERT_TRUE(database.ok()) << database.status();
    ASSERT_TRUE((*database)->Execute("UPDATE blobs SET bytes=x'00' WHERE id < 3").ok());
  }
  Outcome outcome = Run({"verify", "--map", "mine"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.out, HasSubstr("\nlost: cloud 1: damaged\nlost: cloud 2: damaged\n"));
  EXPECT_EQ(outcome.err, "overtone verify: map mine: 2 losses\n");
  outcome = Run({"verify", "--map", "mine", "--json"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.out, HasSubstr("\"losses\":[\"cloud 1: damaged\",\"cloud 2: damaged\"]"));
}

TEST_F(MaintenanceCommandsTest, NothingIsDeletedByAScriptThatDoesNotSayYes) {
  Outcome outcome = Run({"delete", "--map", "mine"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(outcome.err,
            "overtone delete: --yes is needed to delete map mine where nobody can be asked\n");
  outcome = Run({"delete", "--map", "mine", "--mission", "anna/run1"});
  EXPECT_EQ(outcome.err,
            "overtone delete: --yes is needed to delete mission anna/run1 of map mine where nobody "
            "can be asked\n");
  EXPECT_EQ(Run({"delete", "--map", "mine", "--mission", "anna", "--yes"}).exit_code, 2);
  EXPECT_EQ(Settle("mine").missions(), 2);
  EXPECT_THROW(Run({"delete", "--yes"}), CLI::RequiredError);
  EXPECT_THROW(Run({"restore", file_}), CLI::RequiredError);
}

TEST_F(MaintenanceCommandsTest, AMissionAndThenTheMapAreDeleted) {
  EXPECT_THAT(
      OutputOf({"delete", "--map", "mine", "--mission", "anna/run1", "--yes"}),
      AllOf(StartsWith("deleted mission anna/run1 of map mine; "), HasSubstr(" bytes freed\n")));
  EXPECT_EQ(Settle("mine").missions(), 1);
  EXPECT_THAT(OutputOf({"delete", "--map", "mine", "--yes", "--json"}), HasSubstr("freed_bytes"));
  EXPECT_THAT(Maps(), IsEmpty());
  EXPECT_EQ(Run({"delete", "--map", "mine", "--yes"}).exit_code, 2);
}

}  // namespace
}  // namespace overtone
