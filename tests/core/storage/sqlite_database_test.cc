// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/storage/sqlite_database.h"

#include <cstdio>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace overtone {
namespace {

std::string FreshPath(const std::string& name) {
  const std::string path = ::testing::TempDir() + "/" + name;
  std::remove(path.c_str());
  return path;
}

std::unique_ptr<SqliteDatabase> OpenNew(const std::string& path = ":memory:") {
  auto database = SqliteDatabase::Open(path, SqliteDatabase::Mode::kCreate);
  EXPECT_TRUE(database.ok()) << database.status();
  EXPECT_TRUE((*database)->Execute("CREATE TABLE t (id INTEGER PRIMARY KEY, b BLOB)").ok());
  return *std::move(database);
}

TEST(SqliteDatabase, BlobsComeBackWithZerosAndWhenTheyAreEmpty) {
  const auto database = OpenNew();
  const std::vector<std::string> blobs = {std::string("a\0b", 3), "", std::string(100'000, 'x')};
  auto insert = database->Prepare("INSERT INTO t (b) VALUES (?)");
  ASSERT_TRUE(insert.ok()) << insert.status();
  for (const std::string& blob : blobs) ASSERT_TRUE(insert->BindBlob(1, blob).Run().ok());
  auto select = database->Prepare("SELECT b FROM t ORDER BY id");
  ASSERT_TRUE(select.ok());
  std::vector<std::string> read;
  const auto status = select->ForEach([&](const SqliteStatement& row) {
    EXPECT_FALSE(row.IsNull(0));
    read.push_back(row.String(0));
    return absl::OkStatus();
  });
  EXPECT_TRUE(status.ok()) << status;
  EXPECT_EQ(read, blobs);
}

TEST(SqliteDatabase, WhatWasNotCommittedIsNotThere) {
  const auto database = OpenNew();
  {
    auto transaction = SqliteTransaction::Begin(database.get());
    ASSERT_TRUE(transaction.ok());
    ASSERT_TRUE(database->Execute("INSERT INTO t (id) VALUES (1)").ok());
  }
  auto transaction = SqliteTransaction::Begin(database.get());
  ASSERT_TRUE(transaction.ok()) << "the first was not rolled back: " << transaction.status();
  ASSERT_TRUE(database->Execute("INSERT INTO t (id) VALUES (2)").ok());
  ASSERT_TRUE(transaction->Commit().ok());
  EXPECT_EQ(*database->QueryInt("SELECT id FROM t"), 2);
}

TEST(SqliteDatabase, ErrorsSayWhetherTryingAgainHelps) {
  const auto database = OpenNew();
  ASSERT_TRUE(database->Execute("INSERT INTO t (id) VALUES (1)").ok());
  EXPECT_EQ(database->Execute("INSERT INTO t (id) VALUES (1)").code(),
            absl::StatusCode::kAlreadyExists);
  EXPECT_EQ(database->Execute("nonsense").code(), absl::StatusCode::kInternal);
  EXPECT_EQ(database->QueryInt("SELECT id FROM t WHERE id = 7").status().code(),
            absl::StatusCode::kNotFound);
  EXPECT_EQ(SqliteDatabase::Open("/nowhere/at/all", SqliteDatabase::Mode::kCreate).status().code(),
            absl::StatusCode::kNotFound);
  ASSERT_TRUE(database->Execute("PRAGMA max_page_count = 4").ok());
  EXPECT_EQ(database->Execute("INSERT INTO t (b) VALUES (zeroblob(1000000))").code(),
            absl::StatusCode::kResourceExhausted);
}

TEST(SqliteDatabase, AFileThatIsNoDatabaseIsDataLoss) {
  const std::string path = FreshPath("no_database.db");
  std::ofstream(path) << std::string(5000, 'n');
  auto database = SqliteDatabase::Open(path, SqliteDatabase::Mode::kReadWrite);
  ASSERT_TRUE(database.ok()) << "SQLite looks into the file when it needs it";
  EXPECT_EQ((*database)->QueryInt("SELECT count(*) FROM sqlite_schema").status().code(),
            absl::StatusCode::kDataLoss);
}

TEST(SqliteDatabase, ASchemaFormatThatDoesNotExistIsDataLoss) {
  const std::string path = FreshPath("schema_format.db");
  {
    const auto database = SqliteDatabase::Open(path, SqliteDatabase::Mode::kCreate);
    ASSERT_TRUE(database.ok() && (*database)->Execute("CREATE TABLE t (id INTEGER)").ok());
  }
  // https://www.sqlite.org/fileformat2.html, "The Database Header": four bytes from 44 on, 1 to 4;
  // SQLite looks at the last.
  std::fstream(path, std::ios::in | std::ios::out | std::ios::binary).seekp(47) << '\x7f';
  auto database = SqliteDatabase::Open(path, SqliteDatabase::Mode::kReadWrite);
  ASSERT_TRUE(database.ok()) << database.status();
  EXPECT_EQ((*database)->QueryInt("SELECT count(*) FROM sqlite_schema").status().code(),
            absl::StatusCode::kDataLoss);
}

}  // namespace
}  // namespace overtone
