// SPDX-License-Identifier: Apache-2.0
// What the outbox on disk owes beyond what it owes in memory: it survives, and it bears damage and
// full disks.
#include <sys/resource.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/client/internal/submap_outbox.h"
#include "overtone/tests/support/temporary_directory.h"
#include "overtone/v1/submap.pb.h"

namespace overtone {
namespace {

using testing::Contains;
using testing::HasSubstr;

constexpr int64_t kCapacity = 64 << 20;

SharedBytes Bytes(int size, char byte = 'x') {
  return std::make_shared<const std::string>(size, byte);
}

class OutboxOnDiskTest : public ::testing::Test {
 protected:
  // As a new process does.
  absl::Status Reopen(int64_t capacity = kCapacity) {
    outbox_ = nullptr;
    auto outbox = SubmapOutbox::Open(
        capacity, path(),
        Logger([this](LogLevel, absl::string_view line) { log_.emplace_back(line); }));
    if (outbox.ok()) outbox_ = *std::move(outbox);
    return outbox.status();
  }

  // With ten keyframes and a cloud "blob <sequence>".
  void Push(int64_t sequence, int blob_bytes = 1000) {
    v1::Submap submap;
    submap.set_sequence(sequence);
    submap.set_first_index(10 * sequence);
    for (int i = 0; i < 10; ++i) submap.add_keyframes()->set_stamp_ns(100 * sequence + i);
    WaitingSubmap waiting{sequence, 10 * sequence,
                          std::make_shared<const std::string>(submap.SerializeAsString()), 10,
                          100 * sequence + 9};
    ASSERT_TRUE(outbox_
                    ->PushSubmap(std::move(waiting),
                                 {{sequence, Blob(sequence), Bytes(blob_bytes, Letter(sequence))}})
                    .ok());
  }
  static std::string Blob(int64_t sequence) { return "blob " + std::to_string(sequence); }
  static char Letter(int64_t sequence) { return static_cast<char>('a' + sequence % 26); }

  void ExpectIntact(int64_t sequence) {
    const auto bytes = outbox_->ReadSubmap(sequence);
    ASSERT_TRUE(bytes.ok()) << bytes.status();
    v1::Submap submap;
    ASSERT_TRUE(submap.ParseFromString(**bytes));
    EXPECT_EQ(submap.sequence(), sequence);
    const SharedBytes blob = outbox_->FindBlob(Blob(sequence));
    ASSERT_NE(blob, nullptr) << sequence;
    EXPECT_EQ(blob->front(), Letter(sequence));
  }

  std::string path() const { return directory_.File("mission"); }
  int FilesSetAside() const {
    int count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(directory_.path())) {
      const std::string name = entry.path().filename();
      count +=
          name.find(".damaged-") != std::string::npos && name.find("-wal") == std::string::npos;
    }
    return count;
  }

  TemporaryDirectory directory_;
  std::vector<std::string> log_;
  std::unique_ptr<SubmapOutbox> outbox_;
};

TEST_F(OutboxOnDiskTest, GoesOnWhereItWas) {
  ASSERT_TRUE(Reopen().ok());
  for (int64_t i = 0; i < 5; ++i) Push(i);
  ASSERT_TRUE(outbox_->PushLoopClosures(Bytes(3)).ok());
  outbox_->DropBlob(Blob(3));
  ASSERT_TRUE(outbox_->Flush().ok());
  outbox_->RemoveSubmapsThrough(1);
  outbox_->RemoveBlob(Blob(0));
  ASSERT_TRUE(outbox_->Flush().ok());

  ASSERT_TRUE(Reopen().ok());
  const OutboxLevel level = outbox_->Level();
  EXPECT_EQ(level.submaps, 3);
  EXPECT_EQ(level.blobs, 3);
  EXPECT_EQ(level.loop_closure_batches, 1);
  EXPECT_EQ(level.clouds_dropped, 1);
  EXPECT_EQ(level.saved_through, 4);
  EXPECT_EQ(outbox_->Position().next_sequence, 5);
  EXPECT_EQ(outbox_->Position().next_index, 50);
  EXPECT_EQ(outbox_->Position().last_stamp_ns, 409);
  EXPECT_EQ(outbox_->FirstSubmapFrom(0)->sequence, 2);
  EXPECT_EQ(outbox_->FirstSubmapFrom(0)->first_index, 20);
  ExpectIntact(2);
  ExpectIntact(4);
  EXPECT_EQ(outbox_->FrontLoopClosures()->size(), 3u);
  Push(5);
  ASSERT_TRUE(outbox_->Flush().ok());
  ASSERT_TRUE(Reopen().ok());
  EXPECT_EQ(outbox_->Level().submaps, 4);
  EXPECT_TRUE(log_.empty()) << log_[0];
}

TEST_F(OutboxOnDiskTest, RemembersThePositionWhenNothingWaitsAnyMore) {
  ASSERT_TRUE(Reopen().ok());
  Push(0);
  ASSERT_TRUE(outbox_->Flush().ok());
  outbox_->RemoveSubmapsThrough(0);
  outbox_->RemoveBlobsThrough(0);
  ASSERT_TRUE(outbox_->Flush().ok());
  ASSERT_TRUE(Reopen().ok());
  EXPECT_TRUE(outbox_->AwaitEmpty(absl::ZeroDuration()));
  EXPECT_EQ(outbox_->Position().next_sequence, 1);
  EXPECT_EQ(outbox_->Position().next_index, 10);
}

TEST_F(OutboxOnDiskTest, NothingIsSentThatARestartWouldNotRemember) {
  ASSERT_TRUE(Reopen().ok());
  Push(0);
  EXPECT_FALSE(outbox_->FirstSubmapFrom(0).has_value());
  EXPECT_EQ(outbox_->Level().saved_through, -1);
  ASSERT_TRUE(outbox_->Flush().ok());
  EXPECT_TRUE(outbox_->FirstSubmapFrom(0).has_value());
  EXPECT_EQ(outbox_->Level().saved_through, 0);
  EXPECT_EQ(outbox_->Level().synced_through, -1);
  ASSERT_TRUE(outbox_->Sync().ok());
  EXPECT_EQ(outbox_->Level().synced_through, 0);
}

TEST_F(OutboxOnDiskTest, ARefusedSubmapStaysAwayAndItsReplacementStays) {
  ASSERT_TRUE(Reopen().ok());
  for (int64_t i = 0; i < 4; ++i) Push(i);
  ASSERT_TRUE(outbox_->Flush().ok());
  outbox_->RemoveSubmapsFrom(2);
  Push(2, /*blob_bytes=*/77);
  ASSERT_TRUE(outbox_->Flush().ok());
  ASSERT_TRUE(Reopen().ok());
  EXPECT_EQ(outbox_->Level().submaps, 3);
  EXPECT_EQ(outbox_->Position().next_sequence, 3);
  EXPECT_EQ(outbox_->FindBlob(Blob(2))->size(), 77u);
}

TEST_F(OutboxOnDiskTest, AFileHasOneUserAtATime) {
  ASSERT_TRUE(Reopen().ok());
  const auto second = SubmapOutbox::Open(kCapacity, path(), Logger());
  EXPECT_EQ(second.status().code(), absl::StatusCode::kUnavailable);
}

TEST_F(OutboxOnDiskTest, WhatIsForgottenBeforeItIsWrittenNeverComesBack) {
  ASSERT_TRUE(Reopen().ok());
  for (int64_t i = 0; i < 3; ++i) Push(i);
  outbox_->RemoveSubmapsThrough(1);
  outbox_->RemoveBlobsThrough(1);
  ASSERT_TRUE(outbox_->Flush().ok());
  ASSERT_TRUE(Reopen().ok());
  EXPECT_EQ(outbox_->Level().submaps, 1);
  EXPECT_EQ(outbox_->Position().next_sequence, 3);
  ExpectIntact(2);
}

TEST_F(OutboxOnDiskTest, AFileThatIsNoDatabaseIsSetAsideAndANewOneGoesOn) {
  std::ofstream(path()) << std::string(10000, 'z');
  ASSERT_TRUE(Reopen().ok());
  EXPECT_EQ(FilesSetAside(), 1);
  EXPECT_THAT(log_, Contains(HasSubstr("damaged")));
  Push(0);
  ASSERT_TRUE(outbox_->Flush().ok());
  ASSERT_TRUE(Reopen().ok());
  ExpectIntact(0);
}

// Whatever byte of the file is damaged: no crash, no refusal, and what comes back is what was
// written or is told to be lost.
TEST_F(OutboxOnDiskTest, DamageCostsWhatItHitsAndNoMore) {
  constexpr int64_t kSubmaps = 40;
  ASSERT_TRUE(Reopen().ok());
  for (int64_t i = 0; i < kSubmaps; ++i) Push(i, /*blob_bytes=*/3000);
  ASSERT_TRUE(outbox_->Flush().ok());
  outbox_ = nullptr;  // checkpoints: all is in one file
  const auto size = std::filesystem::file_size(path());
  const std::string pristine = directory_.File("pristine");
  std::filesystem::copy_file(path(), pristine);
  int least_submaps = kSubmaps, damaged_runs = 0;
  for (size_t offset = 0; offset < size; offset += 4096 - 31) {
    for (const auto& entry : std::filesystem::directory_iterator(directory_.path())) {
      if (entry.path() != pristine) std::filesystem::remove(entry.path());
    }
    std::filesystem::copy_file(pristine, path());
    {
      std::fstream file(path(), std::ios::in | std::ios::out | std::ios::binary);
      file.seekp(static_cast<std::streamoff>(offset));
      file << std::string(64, '\xa5');
    }
    log_.clear();
    ASSERT_TRUE(Reopen().ok()) << offset;
    int submaps = 0, blobs = 0;
    for (int64_t i = 0; i < kSubmaps; ++i) {
      const auto bytes = outbox_->ReadSubmap(i);
      if (bytes.ok()) {
        v1::Submap submap;
        ASSERT_TRUE(submap.ParseFromString(**bytes)) << offset;
        ++submaps;
      }
      const SharedBytes blob = outbox_->FindBlob(Blob(i));
      if (blob == nullptr) continue;
      ++blobs;
      EXPECT_EQ(*blob, *Bytes(3000, Letter(i)));
    }
    Push(1000);
    EXPECT_TRUE(outbox_->Flush().ok()) << offset;
    EXPECT_TRUE(submaps + blobs == 2 * kSubmaps || !log_.empty()) << offset;
    damaged_runs += submaps + blobs < 2 * kSubmaps;
    // The first page holds what the others mean; without it nothing can be read.
    if (offset >= 4096) least_submaps = std::min(least_submaps, submaps);
  }
  EXPECT_GT(damaged_runs, 10);
  EXPECT_GT(least_submaps, 0);
  std::cout << damaged_runs << " places hit something that waited; the worst left " << least_submaps
            << " of " << kSubmaps << " submaps\n";
}

// The file is overwritten under the open outbox; deleting what was acknowledged finds it out.
TEST_F(OutboxOnDiskTest, DamageThatShowsLaterIsSetAsideToo) {
  constexpr int64_t kSubmaps = 150;
  ASSERT_TRUE(Reopen().ok());
  for (int64_t i = 0; i < kSubmaps; ++i) {
    Push(i, /*blob_bytes=*/100'000);
    ASSERT_TRUE(outbox_->Flush().ok());
  }
  {
    std::fstream file(path(), std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(8192);
    file << std::string(6 << 20, '\xa5');
  }
  outbox_->RemoveSubmapsThrough(99);
  outbox_->RemoveBlobsThrough(99);
  Push(kSubmaps);
  ASSERT_TRUE(outbox_->Flush().ok());
  EXPECT_EQ(FilesSetAside(), 1);
  EXPECT_THAT(log_, Contains(HasSubstr("damaged")));
  EXPECT_EQ(outbox_->Position().next_sequence, kSubmaps + 1);
  const OutboxLevel level = outbox_->Level();
  EXPECT_EQ(level.blobs + level.clouds_dropped, 51);
  EXPECT_GE(level.submaps, 1);
  ExpectIntact(kSubmaps);
  ASSERT_TRUE(Reopen().ok());
  EXPECT_EQ(outbox_->Level().submaps, level.submaps);
  EXPECT_EQ(outbox_->Level().blobs, level.blobs);
  EXPECT_EQ(outbox_->Position().next_sequence, kSubmaps + 1);
  ExpectIntact(kSubmaps);
}

// Files may not grow beyond so many bytes: what a full disk does, to this process alone.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &before_);
    rlimit limit = before_;
    limit.rlim_cur = bytes;
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() { setrlimit(RLIMIT_FSIZE, &before_); }

 private:
  rlimit before_;
};

TEST_F(OutboxOnDiskTest, AFullDiskMeansMemoryUntilThereIsRoomAgain) {
  ASSERT_TRUE(Reopen().ok());
  Push(0);
  ASSERT_TRUE(outbox_->Flush().ok());
  {
    const FileSizeLimit full(64 << 10);
    for (int64_t i = 1; i < 4; ++i) Push(i, /*blob_bytes=*/100'000);
    EXPECT_EQ(outbox_->Flush().code(), absl::StatusCode::kResourceExhausted);
    EXPECT_FALSE(outbox_->Level().disk_ok);
    EXPECT_EQ(outbox_->Level().saved_through, 0);
    EXPECT_EQ(outbox_->FirstSubmapFrom(1)->sequence, 1);
    ExpectIntact(3);
    Push(4);
    EXPECT_FALSE(outbox_->Flush().ok());
    EXPECT_EQ(log_.size(), 1u);
  }
  ASSERT_TRUE(outbox_->Flush().ok());
  EXPECT_TRUE(outbox_->Level().disk_ok);
  EXPECT_EQ(outbox_->Level().saved_through, 4);
  EXPECT_EQ(log_.size(), 2u);
  ASSERT_TRUE(Reopen().ok());
  for (int64_t i = 0; i < 5; ++i) ExpectIntact(i);
}

TEST_F(OutboxOnDiskTest, ADiskThatIsFullFromTheStartMeansMemoryToo) {
  {
    const FileSizeLimit full(0);
    ASSERT_TRUE(Reopen().ok());
    Push(0);
    EXPECT_FALSE(outbox_->Flush().ok());
    EXPECT_FALSE(outbox_->Level().disk_ok);
  }
  ASSERT_TRUE(outbox_->Flush().ok());
  EXPECT_EQ(outbox_->Level().saved_through, 0);
  ASSERT_TRUE(Reopen().ok());
  ExpectIntact(0);
}

// What is removed makes room: the file does not grow with all that ever went through it.
TEST_F(OutboxOnDiskTest, TheFileStaysWithinWhatWaitsAtOnce) {
  ASSERT_TRUE(Reopen(/*capacity=*/4 << 20).ok());
  for (int64_t i = 0; i < 400; ++i) {
    Push(i, /*blob_bytes=*/100'000);
    ASSERT_TRUE(outbox_->Flush().ok());
  }
  EXPECT_GT(outbox_->Level().clouds_dropped, 300);
  EXPECT_LT(std::filesystem::file_size(path()), 8 << 20);
  EXPECT_LT(std::filesystem::file_size(path() + "-wal"), 16 << 20);
}

}  // namespace
}  // namespace overtone
