// SPDX-License-Identifier: Apache-2.0
// The clouds of an upload stream: what is wanted, what is taken, what is refused.
#include <functional>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/proto/conversion/limits.h"
#include "overtone/tests/services/mapping_server/cloud_fixture.h"
#include "overtone/tests/services/mapping_server/server_fixture.h"

namespace overtone {
namespace {

using ::testing::ElementsAre;
using testing::EncodedCloud;
using testing::MakeSubmap;
using testing::MakeSubmapWithClouds;
using testing::ServerTest;
using ::testing::StartsWith;
using testing::Uploader;

const MissionId kMission = {"anna", "run1"};
const MissionId kOther = {"bert", "run1"};

v1::BlobChunk Chunk(const std::string& sha256, int64_t offset, const std::string& data) {
  v1::BlobChunk chunk;
  chunk.set_sha256(sha256);
  chunk.set_offset(offset);
  chunk.set_data(data);
  return chunk;
}

v1::BlobChunk Gone(const std::string& sha256) {
  v1::BlobChunk chunk;
  chunk.set_sha256(sha256);
  chunk.set_gone(true);
  return chunk;
}

void SendWhole(Uploader& uploader, const std::string& blob) {
  for (size_t offset = 0; offset < blob.size(); offset += limits::kMaxBlobChunkBytes) {
    uploader.Write(Chunk(Sha256(blob), offset, blob.substr(offset, limits::kMaxBlobChunkBytes)));
  }
}

std::vector<std::string> Digests(const std::vector<std::string>& blobs) {
  std::vector<std::string> digests;
  for (const std::string& blob : blobs) digests.push_back(Sha256(blob));
  return digests;
}

std::vector<std::string> Wanted(const v1::UploadSubmapsResponse& frame) {
  EXPECT_TRUE(frame.has_want()) << frame.ShortDebugString();
  return {frame.want().sha256().begin(), frame.want().sha256().end()};
}

class UploadBlobsTest : public ServerTest {
 protected:
  // Opens a stream of a mission that has no submaps yet, and sends the first one.
  std::unique_ptr<Uploader> Begin(const MissionId& mission, const Submap& submap) {
    auto uploader = std::make_unique<Uploader>(*mapping_, "mine", mission);
    EXPECT_TRUE(uploader->Read().has_ready());
    EXPECT_EQ(uploader->Send(submap).ack().durable_through_sequence(), 0);
    return uploader;
  }

  v1::MapSummary Summary() {
    v1::ListMapsResponse response;
    grpc::ClientContext context;
    EXPECT_TRUE(admin_->ListMaps(&context, {}, &response).ok());
    return response.maps_size() == 1 ? response.maps(0) : v1::MapSummary();
  }

  void ExpectClouds(int64_t stored, int64_t missing) {
    EXPECT_EQ(Summary().clouds(), stored);
    EXPECT_EQ(Summary().missing_blobs(), missing);
  }
};

TEST_F(UploadBlobsTest, BlobsAreWantedAfterTheirSubmapUntilNothingIsLacking) {
  const std::vector<std::string> blobs = {EncodedCloud(1), EncodedCloud(2), EncodedCloud(3)};
  const auto uploader = Begin(kMission, MakeSubmapWithClouds(0, 0, 5, blobs));
  EXPECT_EQ(Wanted(uploader->Read()), Digests(blobs));
  EXPECT_EQ(UploadState("mine", kMission).missing_blobs(), 3);
  for (const std::string& blob : blobs) {
    SendWhole(*uploader, blob);
    const auto answer = uploader->Read();
    EXPECT_EQ(answer.blob_result().code(), 0) << answer.ShortDebugString();
    EXPECT_EQ(answer.blob_result().sha256(), Sha256(blob));
  }
  EXPECT_THAT(Wanted(uploader->Read()), ElementsAre());
  EXPECT_TRUE(uploader->Close().ok());
  EXPECT_EQ(UploadState("mine", kMission).missing_blobs(), 0);
  ExpectClouds(3, 0);
}

TEST_F(UploadBlobsTest, SubmapsWithoutCloudsAreAnsweredByAcknowledgementsAlone) {
  const auto uploader = Begin(kMission, MakeSubmap(0, 0, 5));
  EXPECT_EQ(uploader->Send(MakeSubmap(1, 5, 5)).ack().durable_through_sequence(), 1);
  EXPECT_TRUE(uploader->Close().ok());
  Uploader next(*mapping_, "mine", kMission);
  EXPECT_EQ(next.Read().ready().next_sequence(), 2);
  EXPECT_THAT(Wanted(next.Read()), ElementsAre());
}

TEST_F(UploadBlobsTest, AStreamCutInTheMiddleOfABlobIsResumedByTheNextOne) {
  const std::string large = EncodedCloud(1, 200'000);
  const std::string small = EncodedCloud(2);
  ASSERT_GT(large.size(), limits::kMaxBlobChunkBytes);
  {
    const auto uploader = Begin(kMission, MakeSubmapWithClouds(0, 0, 5, {large, small}));
    uploader->Read();
    uploader->Write(Chunk(Sha256(large), 0, large.substr(0, limits::kMaxBlobChunkBytes)));
    EXPECT_EQ(UploadState("mine", kMission).missing_blobs(), 2);
  }
  Uploader uploader(*mapping_, "mine", kMission);
  EXPECT_EQ(uploader.Read().ready().next_sequence(), 1);
  EXPECT_EQ(Wanted(uploader.Read()), Digests({large, small}));
  SendWhole(uploader, large);
  EXPECT_EQ(uploader.Read().blob_result().code(), 0);
  SendWhole(uploader, small);
  EXPECT_EQ(uploader.Read().blob_result().code(), 0);
  EXPECT_THAT(Wanted(uploader.Read()), ElementsAre());
  ExpectClouds(2, 0);
}

TEST_F(UploadBlobsTest, SubmapsMayComeBetweenTheChunksOfABlob) {
  const std::string large = EncodedCloud(1, 200'000);
  const auto uploader = Begin(kMission, MakeSubmapWithClouds(0, 0, 5, {large}));
  uploader->Read();
  uploader->Write(Chunk(Sha256(large), 0, large.substr(0, 500'000)));
  EXPECT_EQ(uploader->Send(MakeSubmap(1, 5, 5)).ack().durable_through_sequence(), 1);
  uploader->Write(Chunk(Sha256(large), 500'000, large.substr(500'000)));
  EXPECT_EQ(uploader->Read().blob_result().code(), 0);
}

TEST_F(UploadBlobsTest, ABlobThatAnotherMissionSentIsNotAskedForAgain) {
  const std::string shared = EncodedCloud(1);
  const auto first = Begin(kMission, MakeSubmapWithClouds(0, 0, 5, {shared}));
  first->Read();
  SendWhole(*first, shared);
  EXPECT_EQ(first->Read().blob_result().code(), 0);
  const auto second = Begin(kOther, MakeSubmapWithClouds(0, 0, 5, {shared, shared}));
  EXPECT_THAT(Wanted(second->Read()), ElementsAre());
  ExpectClouds(3, 0);
}

TEST_F(UploadBlobsTest, WhatIsGoneIsWaitedForNoMoreUnlessAnotherMissionHasIt) {
  const std::string shared = EncodedCloud(1);
  const auto first = Begin(kMission, MakeSubmapWithClouds(0, 0, 5, {shared}));
  first->Read();
  first->Write(Gone(Sha256(shared)));
  EXPECT_EQ(first->Read().blob_result().code(), static_cast<int>(absl::StatusCode::kNotFound));
  EXPECT_THAT(Wanted(first->Read()), ElementsAre());
  ExpectClouds(0, 0);
  const auto second = Begin(kOther, MakeSubmapWithClouds(0, 0, 5, {shared}));
  EXPECT_THAT(Wanted(second->Read()), ElementsAre(Sha256(shared)));
  SendWhole(*second, shared);
  EXPECT_EQ(second->Read().blob_result().code(), 0);
  ExpectClouds(2, 0);
}

TEST_F(UploadBlobsTest, WhatIsNotWhatItSaysIsRefusedOnceAndNotWantedAgain) {
  const std::string good = EncodedCloud(1);
  const std::string garbage(300, 'x');
  // 2 million points in a few hundred bytes, and 4 billion in its header.
  PointCloud dense;
  dense.points.assign(kMaxCloudPoints, Eigen::Vector3f::Zero());
  std::string bomb = *EncodePointCloud(dense, {});
  bomb.replace(5, 4, std::string(4, '\xff'));
  std::string damaged = good;
  damaged.back() ^= 1;
  const std::string cut = good.substr(1);
  const struct {
    std::string declared;  // its digest and size are what the submap says
    std::function<void(Uploader&)> send;
    std::string message;
  } cases[] = {
      {good, [&](Uploader& u) { u.Write(Chunk(Sha256(good), 0, damaged)); }, "blob.sha256:"},
      {garbage, [&](Uploader& u) { SendWhole(u, garbage); }, "blob.data."},
      {bomb, [&](Uploader& u) { SendWhole(u, bomb); }, "blob.data."},
      {cut, [&](Uploader& u) { SendWhole(u, cut); }, "blob.data."},
      {good, [&](Uploader& u) { u.Write(Chunk(Sha256(good), 0, good + "x")); }, "blob.data:"},
      {good, [&](Uploader& u) { u.Write(Chunk(Sha256(good), 7, good.substr(7))); }, "blob.offset:"},
      {good, [&](Uploader& u) { u.Write(Chunk(Sha256(good), -1, good)); }, "blob.offset:"},
      {good,
       [&](Uploader& u) {
         u.Write(Chunk(Sha256(good), 0, std::string(limits::kMaxBlobChunkBytes + 1, 'x')));
       },
       "blob.data:"},
  };
  int robot = 0;
  for (const auto& bad : cases) {
    const MissionId mission = {"robot" + std::to_string(robot++), "run"};
    const auto uploader = Begin(mission, MakeSubmapWithClouds(0, 0, 5, {bad.declared}));
    EXPECT_EQ(Wanted(uploader->Read()), Digests({bad.declared}));
    bad.send(*uploader);
    const auto answer = uploader->Read();
    EXPECT_EQ(answer.blob_result().code(), static_cast<int>(absl::StatusCode::kInvalidArgument));
    EXPECT_THAT(answer.blob_result().message(), StartsWith(bad.message));
    EXPECT_THAT(Wanted(uploader->Read()), ElementsAre());
    EXPECT_EQ(UploadState("mine", mission).missing_blobs(), 0);
    EXPECT_EQ(uploader->Send(MakeSubmap(1, 5, 5)).ack().durable_through_sequence(), 1);
  }
  ExpectClouds(0, 0);
}

TEST_F(UploadBlobsTest, TheRestOfARefusedBlobIsPassedOver) {
  const std::string large = EncodedCloud(1, 400'000);
  ServerOptions options = testing::TestOptions();
  options.limits.max_blob_bytes = 1000;
  StartServer(options);
  const auto uploader = Begin(kMission, MakeSubmapWithClouds(0, 0, 5, {large}));
  uploader->Read();
  SendWhole(*uploader, large);  // three chunks, one answer
  const auto answer = uploader->Read();
  EXPECT_EQ(answer.blob_result().code(), static_cast<int>(absl::StatusCode::kInvalidArgument));
  EXPECT_THAT(answer.blob_result().message(), ::testing::HasSubstr("1000 at most"));
  EXPECT_THAT(Wanted(uploader->Read()), ElementsAre());
  EXPECT_EQ(uploader->Send(MakeSubmap(1, 5, 5)).ack().durable_through_sequence(), 1);
}

TEST_F(UploadBlobsTest, ABlobThatNobodyAskedForIsRefused) {
  const std::string unknown = EncodedCloud(1);
  const int refused = static_cast<int>(absl::StatusCode::kFailedPrecondition);
  Uploader uploader(*mapping_, "mine", kMission);
  uploader.Read();
  SendWhole(uploader, unknown);  // before there is a map
  EXPECT_EQ(uploader.Read().blob_result().code(), refused);
  EXPECT_TRUE(uploader.Send(MakeSubmap(0, 0, 5)).has_ack());
  SendWhole(uploader, unknown);
  EXPECT_EQ(uploader.Read().blob_result().code(), refused);
  uploader.Write(Gone("short"));
  EXPECT_EQ(uploader.Read().blob_result().code(), refused);
  EXPECT_TRUE(uploader.Send(MakeSubmap(1, 5, 5)).has_ack());
}

TEST_F(UploadBlobsTest, WithoutRoomPosesAreTakenAndBlobsWantedByTheNextStreamOnly) {
  const std::vector<std::string> blobs = {EncodedCloud(1), EncodedCloud(2)};
  ServerOptions options = testing::TestOptions();
  options.limits.max_stored_blob_bytes = static_cast<int64_t>(blobs[0].size());
  StartServer(options);
  {
    const auto uploader = Begin(kMission, MakeSubmapWithClouds(0, 0, 5, blobs));
    uploader->Read();
    SendWhole(*uploader, blobs[0]);
    EXPECT_EQ(uploader->Read().blob_result().code(), 0);
    SendWhole(*uploader, blobs[1]);
    EXPECT_EQ(uploader->Read().blob_result().code(),
              static_cast<int>(absl::StatusCode::kResourceExhausted));
    const Submap next = MakeSubmapWithClouds(1, 5, 5, {EncodedCloud(3)});
    EXPECT_EQ(uploader->Send(next).ack().durable_through_sequence(), 1);
    EXPECT_TRUE(uploader->Close().ok());
  }
  Uploader uploader(*mapping_, "mine", kMission);
  uploader.Read();
  EXPECT_EQ(Wanted(uploader.Read()), Digests({blobs[1], EncodedCloud(3)}));
  ExpectClouds(1, 2);
}

TEST_F(UploadBlobsTest, ALongBacklogIsAskedForBitByBit) {
  std::vector<std::string> blobs;
  for (int i = 0; i < 600; ++i) blobs.push_back(EncodedCloud(i, 3));
  const auto uploader = Begin(kMission, MakeSubmapWithClouds(0, 0, 600, blobs));
  size_t asked = 0, sent = 0, answered = 0;
  while (answered < blobs.size()) {
    const auto frame = uploader->Read();
    if (frame.has_want()) {
      ASSERT_LE(frame.want().sha256_size(), 256);
      for (const std::string& sha256 : frame.want().sha256()) {
        ASSERT_EQ(sha256, Sha256(blobs[asked++]));
      }
      ASSERT_LE(asked - answered, 256u);
      while (sent < asked) SendWhole(*uploader, blobs[sent++]);
    } else {
      ASSERT_EQ(frame.blob_result().code(), 0) << frame.ShortDebugString();
      ++answered;
    }
  }
  EXPECT_THAT(Wanted(uploader->Read()), ElementsAre());
  ExpectClouds(600, 0);
}

}  // namespace
}  // namespace overtone
