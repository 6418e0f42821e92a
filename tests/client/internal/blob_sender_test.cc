// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/internal/blob_sender.h"

#include <string>
#include <vector>

#include "gtest/gtest.h"
#include "overtone/proto/conversion/limits.h"

namespace overtone {
namespace {

constexpr int64_t kWindow = 4 << 20;
constexpr int64_t kChunk = limits::kMaxBlobChunkBytes;

class BlobSenderTest : public ::testing::Test {
 protected:
  // A submap with a cloud of that name and size, the same byte throughout.
  void Push(int64_t sequence, const std::string& sha256, int64_t size, char byte = 'x') {
    const auto bytes = std::make_shared<const std::string>(size, byte);
    const auto submap = std::make_shared<const std::string>("submap");
    ASSERT_TRUE(
        outbox_.PushSubmap({sequence, 10 * sequence, submap}, {{sequence, sha256, bytes}}).ok());
  }

  absl::Status Want(const std::vector<std::string>& sha256, int64_t acknowledged_through = 0) {
    v1::UploadWant want;
    for (const std::string& digest : sha256) want.add_sha256(digest);
    return sender_.OnWant(want, acknowledged_through);
  }

  absl::Status Answer(const std::string& sha256, absl::StatusCode code) {
    v1::UploadBlobResult result;
    result.set_sha256(sha256);
    result.set_code(static_cast<int>(code));
    return sender_.OnResult(result);
  }

  // "sha256 offset size", or "sha256 gone", or "-".
  std::string Next(int64_t window_bytes = kWindow) {
    const auto request = sender_.Next(window_bytes);
    if (!request) return "-";
    const v1::BlobChunk& chunk = request->blob();
    if (chunk.gone()) return chunk.sha256() + " gone";
    return chunk.sha256() + " " + std::to_string(chunk.offset()) + " " +
           std::to_string(chunk.data().size());
  }

  SubmapOutbox outbox_{64 << 20};
  BlobSender sender_{&outbox_};
};

TEST_F(BlobSenderTest, SendsWhatIsWantedInThatOrderAndNothingElse) {
  Push(0, "a", 10);
  Push(1, "b", 20);
  Push(2, "c", 30);
  EXPECT_EQ(Next(), "-");
  ASSERT_TRUE(Want({"c", "a"}).ok());
  EXPECT_EQ(Next(), "c 0 30");
  EXPECT_EQ(Next(), "a 0 10");
  EXPECT_EQ(Next(), "-");
  ASSERT_TRUE(Answer("c", absl::StatusCode::kOk).ok());
  EXPECT_EQ(outbox_.FindBlob("c"), nullptr);
  EXPECT_NE(outbox_.FindBlob("a"), nullptr);
  EXPECT_EQ(outbox_.Level().clouds_dropped, 0);
}

TEST_F(BlobSenderTest, ALargeBlobGoesInChunksThatFollowEachOther) {
  Push(0, "a", 2 * kChunk + 1);
  Push(1, "b", 5);
  ASSERT_TRUE(Want({"a", "b"}).ok());
  EXPECT_EQ(Next(), "a 0 524288");
  EXPECT_EQ(Next(), "a 524288 524288");
  EXPECT_EQ(Next(), "a 1048576 1");
}

TEST_F(BlobSenderTest, AQuarterOfTheWindowIsUnansweredAtMostUnlessOneBlobAloneIsLarger) {
  for (const char* name : {"a", "b", "c"}) Push(name[0] - 'a', name, 100);
  Push(3, "large", kChunk);
  ASSERT_TRUE(Want({"a", "b", "c", "large"}).ok());
  EXPECT_EQ(Next(800), "a 0 100");
  EXPECT_EQ(Next(800), "b 0 100");
  EXPECT_EQ(Next(800), "-");
  EXPECT_EQ(sender_.bytes_in_flight(), 200);
  ASSERT_TRUE(Answer("a", absl::StatusCode::kOk).ok());
  EXPECT_EQ(Next(800), "c 0 100");
  ASSERT_TRUE(Answer("c", absl::StatusCode::kOk).ok());
  EXPECT_EQ(Next(800), "-");
  ASSERT_TRUE(Answer("b", absl::StatusCode::kOk).ok());
  EXPECT_EQ(Next(800), "large 0 524288");
}

TEST_F(BlobSenderTest, WhatIsNotThereAnyMoreIsGone) {
  Push(0, "a", 10);
  ASSERT_TRUE(Want({"dropped", "a"}, /*acknowledged_through=*/0).ok());
  EXPECT_EQ(Next(), "dropped gone");
  EXPECT_EQ(Next(), "a 0 10");
  EXPECT_TRUE(Answer("dropped", absl::StatusCode::kNotFound).ok());
  EXPECT_EQ(outbox_.Level().clouds_dropped, 0);
}

TEST_F(BlobSenderTest, ARefusalForGoodEndsABlobInTheMiddle) {
  Push(0, "a", 2 * kChunk);
  Push(1, "b", 5);
  ASSERT_TRUE(Want({"a", "b"}).ok());
  EXPECT_EQ(Next(), "a 0 524288");
  ASSERT_TRUE(Answer("a", absl::StatusCode::kInvalidArgument).ok());
  EXPECT_EQ(Next(), "b 0 5");
  EXPECT_EQ(outbox_.FindBlob("a"), nullptr);
  EXPECT_EQ(outbox_.Level().clouds_dropped, 1);
}

TEST_F(BlobSenderTest, WithoutRoomAtTheServerBlobsStayForTheNextStream) {
  Push(0, "a", 10);
  Push(1, "b", 10);
  ASSERT_TRUE(Want({"a", "b"}).ok());
  EXPECT_EQ(Next(), "a 0 10");
  ASSERT_TRUE(Answer("a", absl::StatusCode::kResourceExhausted).ok());
  EXPECT_EQ(Next(), "-");
  EXPECT_EQ(outbox_.Level().blobs, 2);
  BlobSender next_stream(&outbox_);
  v1::UploadWant want;
  want.add_sha256("a");
  ASSERT_TRUE(next_stream.OnWant(want, /*acknowledged_through=*/1).ok());
  EXPECT_EQ(next_stream.Next(kWindow)->blob().data().size(), 10u);
}

TEST_F(BlobSenderTest, AnEmptyWantFreesTheBlobsOfAcknowledgedSubmapsOnly) {
  Push(0, "a", 10);
  Push(1, "b", 10);
  Push(2, "c", 10);
  ASSERT_TRUE(Want({}, /*acknowledged_through=*/1).ok());
  EXPECT_EQ(outbox_.FindBlob("a"), nullptr);
  EXPECT_EQ(outbox_.FindBlob("b"), nullptr);
  EXPECT_NE(outbox_.FindBlob("c"), nullptr);
  EXPECT_EQ(outbox_.Level().clouds_dropped, 0);
}

// The server holds submaps 0 and 1 of the mission's first run, and lacks both their clouds.
TEST_F(BlobSenderTest, AHostThatStartedOverIsWaitedForBeforeAnythingIsGone) {
  ASSERT_TRUE(Want({"a", "lost", "b"}, /*acknowledged_through=*/1).ok());
  EXPECT_EQ(Next(), "-");
  Push(0, "a", 10);
  EXPECT_EQ(Next(), "a 0 10");
  EXPECT_EQ(Next(), "-");
  Push(1, "b", 10);
  EXPECT_EQ(Next(), "lost gone");
  EXPECT_EQ(Next(), "b 0 10");
}

// A host that started over, after the server has said that it lacks nothing.
TEST_F(BlobSenderTest, WhatIsHandedOverAnewIsFreedByTheEarlierWord) {
  ASSERT_TRUE(Want({}, /*acknowledged_through=*/0).ok());
  Push(0, "a", 10);
  Push(1, "b", 10);
  EXPECT_EQ(Next(), "-");
  EXPECT_EQ(outbox_.FindBlob("a"), nullptr);
  EXPECT_NE(outbox_.FindBlob("b"), nullptr);
}

// A broken server must not make the robot throw its data away, nor fill its memory.
TEST_F(BlobSenderTest, DoesNotBelieveEveryWord) {
  Push(0, "a", 10);
  EXPECT_EQ(Answer("a", absl::StatusCode::kOk).code(), absl::StatusCode::kInternal);
  EXPECT_NE(outbox_.FindBlob("a"), nullptr);
  absl::Status status;
  for (int i = 0; i < 100 && status.ok(); ++i) status = Want(std::vector<std::string>(256, "z"));
  EXPECT_EQ(status.code(), absl::StatusCode::kInternal);
}

}  // namespace
}  // namespace overtone
