// SPDX-License-Identifier: Apache-2.0
// Files of a small store, changed at random while it is closed: nothing crashes, nothing wrong is
// told, every entry is told as it was or named as lost. OVERTONE_TEST_STORE_MUTATIONS: how many.
#include <chrono>
#include <cstdio>
#include <fstream>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/tests/fault/store_samples.h"
#include "overtone/tests/support/fault_table.h"
#include "overtone/tests/support/fault_vfs.h"
#include "spdlog/spdlog.h"

namespace overtone {
namespace {

using testing::MakeClosure;
using testing::RecordOf;

const MissionId kAnna = {"anna", "run"};
const MissionId kBert = {"bert", "run"};

using Files = std::map<std::string, std::string>;  // content by suffix: "", "-wal", "-mark"

std::string ReadWhole(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(file), {});
}

enum class Mutation { kFlipBits, kTruncate, kZeroPage, kGarbage, kSwapPages, kRemove };
const char* const kNames[] = {"bits flipped", "truncated",     "page zeroed",
                              "garbage",      "pages swapped", "file removed"};

void Mutate(Mutation mutation, std::mt19937& random, std::string& bytes) {
  const auto any = [&](size_t end) {
    return std::uniform_int_distribution<size_t>(0, end - 1)(random);
  };
  const size_t pages = std::max<size_t>(1, bytes.size() / 4096);
  switch (mutation) {
    case Mutation::kFlipBits:
      for (size_t flips = 1 + any(8); flips > 0; --flips) {
        bytes[any(bytes.size())] ^= static_cast<char>(1 << any(8));
      }
      break;
    case Mutation::kTruncate:
    case Mutation::kRemove:
      bytes.resize(any(bytes.size()));
      break;
    case Mutation::kZeroPage: {
      const size_t start = 4096 * any(pages);
      bytes.replace(start, std::min<size_t>(4096, bytes.size() - start),
                    std::min<size_t>(4096, bytes.size() - start), '\0');
      break;
    }
    case Mutation::kGarbage: {
      size_t at = any(bytes.size());
      for (size_t size = 1 + any(600); size > 0 && at < bytes.size(); --size) {
        bytes[at++] = static_cast<char>(random());
      }
      break;
    }
    case Mutation::kSwapPages: {
      const std::string whole = bytes;
      const size_t a = any(pages), b = any(pages);
      bytes.replace(4096 * a, 4096, whole, 4096 * b, 4096);
      bytes.resize(whole.size());
      break;
    }
  }
}

class StoreMutationTest : public ::testing::Test {
 protected:
  StoreMutationTest() {
    spdlog::set_level(spdlog::level::off);
    FaultVfs::Instance().Reset();
    options_.vfs = FaultVfs::name();
  }

  void Open(const std::string& path, testing::Transcript& transcript) {
    auto store = SqliteSubmapStore::Open(path, ServerLimits(), transcript.Sink(&store_), options_);
    ASSERT_TRUE(store.ok()) << store.status();
    store_ = *std::move(store);
    const absl::Status status = store_->Replay();
    ASSERT_TRUE(status.ok()) << status;
  }

  // Eleven log entries, and clouds; once as they lie after a clean end, once as after a kill, when
  // half of it is in the write-ahead log.
  void MakeSamples() {
    const std::string path = folder_.File("sample");
    testing::Transcript transcript;
    Open(path, transcript);
    Fill(0);
    store_.reset();
    Open(path, transcript);  // the first half is in the file now
    Fill(1);
    for (const char* suffix : {"", "-wal", "-mark"}) killed_[suffix] = ReadWhole(path + suffix);
    store_.reset();
    for (const char* suffix : {"", "-mark"}) closed_[suffix] = ReadWhole(path + suffix);
    testing::Transcript all;
    Open(path, all);
    original_ = all.entries();
    clouds_ = all.clouds();
    store_.reset();
    ASSERT_EQ(original_.size(), 12u);
    ASSERT_EQ(clouds_.size(), 8u);
  }

  void Fill(int half) {
    for (int i = 2 * half; i < 2 * half + 2; ++i) {
      for (const MissionId& mission : {kAnna, kBert}) {
        const std::string blob = testing::EncodedCloud(2 * i + (mission == kBert), 600);
        ASSERT_TRUE(testing::Append(*store_, RecordOf(mission, i, {blob})).ok());
        ASSERT_TRUE(testing::PutBlob(*store_, blob).ok());
      }
    }
    ASSERT_TRUE(
        testing::AppendClosures(*store_, {RecordOf(MakeClosure({kAnna, half}, {kBert, 4}))}).ok());
    ASSERT_TRUE(testing::AppendFinding(*store_, {"found " + std::to_string(half), {}}).ok());
    ASSERT_TRUE(testing::PutSnapshot(*store_, std::string(3000, 's')).ok());
  }

  struct Outcome {
    bool reported = false;
    size_t told = 0;
    size_t clouds = 0;
  };

  // What is told is a subsequence of the original, and what is not is named.
  Outcome Judge(const testing::Transcript& transcript) {
    const std::vector<std::string> losses = store_->Verify().losses;
    const std::set<int64_t> named =
        testing::NamedPositions(losses, static_cast<int64_t>(original_.size()));
    const std::vector<std::string> told = transcript.entries();
    size_t next = 0;
    for (size_t i = 0; i < original_.size(); ++i) {
      if (next < told.size() && told[next] == original_[i]) {
        ++next;
      } else {
        EXPECT_TRUE(named.count(static_cast<int64_t>(i) + 1) > 0)
            << "entry " << i + 1 << " is missing without a word; "
            << ::testing::PrintToString(losses);
      }
    }
    EXPECT_EQ(next, told.size()) << "told what was never stored, or twice";
    for (const auto& [keyframe, bytes] : transcript.clouds()) {
      EXPECT_TRUE(clouds_.at(keyframe) == bytes) << keyframe;
    }
    return {!losses.empty(), told.size(), transcript.clouds().size()};
  }

  StoreOptions options_;
  TemporaryDirectory folder_{testing::FastFolder()};
  std::unique_ptr<SqliteSubmapStore> store_;
  Files closed_, killed_;
  std::vector<std::string> original_;
  std::map<std::string, std::string> clouds_;
};

TEST_F(StoreMutationTest, WhateverHappensToTheFilesNothingWrongIsTold) {
  const int64_t mutations = testing::RunsFromEnvironment("OVERTONE_TEST_STORE_MUTATIONS", 10'000);
  ASSERT_NO_FATAL_FAILURE(MakeSamples());
  struct Row {
    int64_t count = 0, reported = 0, harmless = 0, salvaged = 0, entries = 0, clouds = 0;
  };
  std::map<std::string, Row> table;
  std::mt19937 random(20260102);
  for (int64_t i = 0; i < mutations && !HasFailure(); ++i) {
    Files files = i % 2 == 0 ? closed_ : killed_;
    std::vector<std::string> targets = {"", "", "-mark"};
    if (i % 2 == 1) targets = {"", "-wal", "-wal", "-mark"};
    const std::string target = targets[random() % targets.size()];
    const auto mutation = static_cast<Mutation>(random() % 6);
    SCOPED_TRACE("mutation " + std::to_string(i) + ": " + kNames[static_cast<int>(mutation)] +
                 " in map" + target);
    Mutate(mutation, random, files[target]);
    if (mutation == Mutation::kRemove) files.erase(target);

    TemporaryDirectory folder(folder_.path());
    const std::string path = folder.File("map");
    for (const auto& [suffix, bytes] : files) {
      std::ofstream(path + suffix, std::ios::binary) << bytes;
    }
    testing::Transcript transcript;
    ASSERT_NO_FATAL_FAILURE(Open(path, transcript));
    const Outcome outcome = Judge(transcript);
    store_.reset();

    Row& row = table[std::string(i % 2 == 0 ? "closed: " : "killed: ") + "map" + target + " " +
                     kNames[static_cast<int>(mutation)]];
    ++row.count;
    row.reported += outcome.reported;
    row.harmless += !outcome.reported;
    for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
      row.salvaged += absl::StrContains(entry.path().string(), ".damaged-") &&
                      !absl::EndsWith(entry.path().string(), "-wal");
    }
    row.entries += outcome.told;
    row.clouds += outcome.clouds;
    // Without a report nothing may be missing: neither entries nor clouds.
    if (!outcome.reported) {
      EXPECT_EQ(outcome.told, original_.size());
    }
    FaultVfs::Instance().Reset();
  }
  std::printf("%-32s %9s %9s %9s %9s %12s %12s\n", "files, mutation", "mutations", "reported",
              "harmless", "salvaged", "entries kept", "clouds kept");
  Row sum;
  for (const auto& [name, row] : table) {
    std::printf("%-32s %9ld %9ld %9ld %9ld %11.1f%% %11.1f%%\n", name.c_str(), row.count,
                row.reported, row.harmless, row.salvaged,
                100.0 * row.entries / (row.count * original_.size()),
                100.0 * row.clouds / (row.count * clouds_.size()));
    sum.count += row.count;
    sum.reported += row.reported;
    sum.harmless += row.harmless;
    sum.salvaged += row.salvaged;
    sum.entries += row.entries;
    sum.clouds += row.clouds;
  }
  std::printf("%-32s %9ld %9ld %9ld %9ld %11.1f%% %11.1f%%\ncrashes 0, wrong entries told 0\n",
              "all", sum.count, sum.reported, sum.harmless, sum.salvaged,
              100.0 * sum.entries / (sum.count * original_.size()),
              100.0 * sum.clouds / (sum.count * clouds_.size()));
  FaultRow(
      "store", absl::StrCat(sum.count, " mutations of its files"),
      absl::StrFormat("reported %d, harmless %d, salvaged %d; entries kept %.1f %%, clouds kept "
                      "%.1f %%; crashes 0, wrong entries told 0",
                      sum.reported, sum.harmless, sum.salvaged,
                      100.0 * sum.entries / (sum.count * original_.size()),
                      100.0 * sum.clouds / (sum.count * clouds_.size())));
}

}  // namespace
}  // namespace overtone
