// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/data_directory.h"

#include <filesystem>
#include <fstream>
#include <string>

#include "absl/synchronization/notification.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/services/mapping_server/submap_store/sqlite_submap_store.h"

namespace overtone {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class DataDirectoryTest : public ::testing::Test {
 protected:
  DataDirectoryTest() { std::filesystem::remove_all(path_); }
  ~DataDirectoryTest() override { std::filesystem::remove_all(path_); }

  const std::string path_ = ::testing::TempDir() + "/data_directory_test";
};

TEST_F(DataDirectoryTest, FoldersAreMadeForTheServersUserOnly) {
  DataDirectory directory(path_ + "/deep/down");
  ASSERT_TRUE(directory.Open().ok());
  const auto store = directory.Prepare("campus");
  ASSERT_TRUE(store.ok()) << store.status();
  EXPECT_EQ(*store, path_ + "/deep/down/maps/campus/map.db");
  const auto mode = std::filesystem::status(path_ + "/deep/down/maps/campus").permissions();
  EXPECT_EQ(mode & std::filesystem::perms::all, std::filesystem::perms::owner_all);
}

TEST_F(DataDirectoryTest, TwoServersDoNotShareOne) {
  DataDirectory first(path_);
  ASSERT_TRUE(first.Open().ok());
  {
    DataDirectory second(path_);
    const absl::Status status = second.Open();
    EXPECT_EQ(status.code(), absl::StatusCode::kFailedPrecondition);
    EXPECT_THAT(status.message(), HasSubstr("data_dir: another server"));
  }
}

TEST_F(DataDirectoryTest, TheLockGoesWithItsHolder) {
  { ASSERT_TRUE(DataDirectory(path_).Open().ok()); }
  EXPECT_TRUE(DataDirectory(path_).Open().ok());
}

TEST_F(DataDirectoryTest, WhereNothingCanBeMadeTheOptionIsNamed) {
  std::ofstream(path_) << "a file";
  const absl::Status status = DataDirectory(path_ + "/x").Open();
  EXPECT_FALSE(status.ok());
  EXPECT_THAT(status.message(), HasSubstr("data_dir: "));
}

TEST_F(DataDirectoryTest, MapsAreTheFoldersWhoseNamesAreIds) {
  DataDirectory directory(path_);
  ASSERT_TRUE(directory.Open().ok());
  for (const char* map : {"b", "a", "c"}) ASSERT_TRUE(directory.Prepare(map).ok());
  std::filesystem::create_directory(path_ + "/maps/Not an id");
  EXPECT_THAT(directory.Maps(), ElementsAre("a", "b", "c"));
  ASSERT_TRUE(directory.Remove("b").ok());
  EXPECT_TRUE(directory.Remove("b").ok());
  EXPECT_THAT(directory.Maps(), ElementsAre("a", "c"));
}

TEST_F(DataDirectoryTest, WhatWasSetAsideOutlivesAnEmptyStore) {
  DataDirectory directory(path_);
  ASSERT_TRUE(directory.Open().ok());
  for (const char* map : {"a", "b"}) {
    SubmapStore::Sink sink;
    sink.on_finding = [](const std::string&) {};
    auto store = SqliteSubmapStore::Open(*directory.Prepare(map), ServerLimits(), sink);
    ASSERT_TRUE(store.ok()) << store.status();
    ASSERT_TRUE((*store)->Replay().ok());
    absl::Notification stored;
    (*store)->AppendFinding({"epoch", {}}, [&](const absl::Status&) { stored.Notify(); });
    stored.WaitForNotification();
    EXPECT_TRUE(directory.Has(map));
  }
  std::ofstream(path_ + "/maps/b/map.db.damaged") << "what is left";
  directory.RemoveEmpty("a");
  directory.RemoveEmpty("b");
  EXPECT_THAT(directory.Maps(), ElementsAre("b"));
  EXPECT_FALSE(directory.Has("b"));
}

TEST_F(DataDirectoryTest, InMemoryNothingIsWritten) {
  DataDirectory directory(DataDirectory::kMemory);
  ASSERT_TRUE(directory.Open().ok());
  EXPECT_EQ(*directory.Prepare("a"), ":memory:");
  EXPECT_THAT(directory.Maps(), IsEmpty());
  EXPECT_FALSE(directory.Has("a"));
}

TEST_F(DataDirectoryTest, WhatAnEmptyMapLeavesOfItsStoreGoes) {
  DataDirectory directory(path_);
  ASSERT_TRUE(directory.Open().ok());
  ASSERT_TRUE(directory.Prepare("a").ok());
  for (const char* file : {"map.db", "map.db-wal", "map.db-shm", "map.db-mark"}) {
    std::ofstream(path_ + "/maps/a/" + file) << "12345";
  }
  EXPECT_EQ(directory.BytesOf("a"), 20);
  directory.RemoveEmpty("a");
  EXPECT_THAT(directory.Maps(), IsEmpty());
}

}  // namespace
}  // namespace overtone
