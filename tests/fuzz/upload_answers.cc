// SPDX-License-Identifier: Apache-2.0
// What a robot is answered on UploadSubmaps, whatever the server: the senders keep count or end the
// stream.
#include "overtone/client/internal/blob_sender.h"
#include "overtone/client/internal/submap_sender.h"
#include "overtone/proto/conversion/submap_conversion.h"
#include "overtone/tests/fuzz/message_input.h"
#include "overtone/tests/proto/conversion_fixture.h"

namespace overtone::fuzz {
namespace {

constexpr int64_t kOutboxBytes = 1 << 20;
constexpr int kMaxFramesBetweenAnswers = 8;

// Three submaps of two keyframes, each with a cloud whose digest is its number repeated.
void Fill(SubmapOutbox* outbox) {
  for (int64_t sequence = 0; sequence < 3; ++sequence) {
    const Submap submap = testing::MakeSubmap(sequence, 2 * sequence, 2);
    const std::string digest(32, static_cast<char>('0' + sequence));
    const absl::Status pushed = outbox->PushSubmap(
        {sequence, 2 * sequence,
         std::make_shared<const std::string>(ToProto(submap).SerializeAsString())},
        {{sequence, digest, std::make_shared<const std::string>(100 * (sequence + 1), 'c')}});
    FUZZ_CHECK(pushed.ok(), pushed.ToString());
  }
}

absl::Status Handle(const v1::UploadSubmapsResponse& answer, SubmapSender* submaps,
                    BlobSender* blobs) {
  switch (answer.frame_case()) {
    case v1::UploadSubmapsResponse::kReady:
      return submaps->OnReady(answer.ready());
    case v1::UploadSubmapsResponse::kAck:
      return submaps->OnAck(answer.ack());
    case v1::UploadSubmapsResponse::kReject:
      return submaps->CheckReject(answer.reject());
    case v1::UploadSubmapsResponse::kWant:
      return blobs->OnWant(answer.want(), submaps->acknowledged_through());
    case v1::UploadSubmapsResponse::kBlobResult:
      return blobs->OnResult(answer.blob_result());
    case v1::UploadSubmapsResponse::FRAME_NOT_SET:
      return absl::OkStatus();
  }
  return absl::OkStatus();
}

// As much as the window lets out. False: the stream must end.
bool SendAll(SubmapSender* submaps, BlobSender* blobs) {
  for (int i = 0; i < kMaxFramesBetweenAnswers; ++i) {
    const auto submap = submaps->Next(blobs->bytes_in_flight());
    if (!submap.ok()) return false;
    if (!submap->has_value() && !blobs->Next(submaps->window_bytes()).has_value()) return true;
  }
  return true;
}

void Run(absl::string_view input) {
  SubmapOutbox outbox(kOutboxBytes);
  Fill(&outbox);
  SubmapSender submaps(&outbox);
  BlobSender blobs(&outbox);
  for (const absl::string_view bytes : Messages(input)) {
    v1::UploadSubmapsResponse answer;
    if (!Parse(bytes, &answer)) continue;
    if (!Handle(answer, &submaps, &blobs).ok() || !SendAll(&submaps, &blobs)) return;
    FUZZ_CHECK(submaps.bytes_in_flight() >= 0 && blobs.bytes_in_flight() >= 0,
               "less than nothing is under way");
  }
}

}  // namespace
}  // namespace overtone::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  overtone::fuzz::Run(overtone::fuzz::AsText(data, size));
  return 0;
}

extern "C" size_t LLVMFuzzerCustomMutator(uint8_t* data, size_t size, size_t max_size,
                                          unsigned seed) {
  return overtone::fuzz::MutateFrames<overtone::v1::UploadSubmapsResponse>(data, size, max_size,
                                                                           seed);
}
