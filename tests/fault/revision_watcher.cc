// SPDX-License-Identifier: Apache-2.0
#include "overtone/tests/fault/revision_watcher.h"

#include <utility>

#include "absl/time/time.h"
#include "grpcpp/create_channel.h"
#include "grpcpp/security/credentials.h"

namespace overtone {
namespace {

constexpr absl::Duration kPause = absl::Milliseconds(20);  // between two streams

std::shared_ptr<grpc::Channel> Channel(const std::string& address) {
  grpc::ChannelArguments arguments;
  arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, 20);
  arguments.SetInt(GRPC_ARG_MIN_RECONNECT_BACKOFF_MS, 1000);
  arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, 20);
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  arguments.SetMaxReceiveMessageSize(64 << 20);
  return grpc::CreateCustomChannel(address, grpc::InsecureChannelCredentials(), arguments);
}

}  // namespace

RevisionWatcher::RevisionWatcher(const std::string& address, std::string map)
    : map_(std::move(map)),
      stub_(v1::MappingService::NewStub(Channel(address))),
      thread_([this] { Run(); }) {}

RevisionWatcher::~RevisionWatcher() {
  {
    absl::MutexLock lock(&mutex_);
    stopping_ = true;
    if (context_ != nullptr) context_->TryCancel();
  }
  thread_.join();
}

RevisionWatcher::Books RevisionWatcher::books() const {
  absl::MutexLock lock(&mutex_);
  return books_;
}

void RevisionWatcher::Run() {
  while (true) {
    grpc::ClientContext context;
    {
      absl::MutexLock lock(&mutex_);
      if (stopping_) return;
      context_ = &context;
    }
    RunStream(&context);
    absl::MutexLock lock(&mutex_);
    context_ = nullptr;
    if (mutex_.AwaitWithTimeout(absl::Condition(&stopping_), kPause)) return;
  }
}

void RevisionWatcher::RunStream(grpc::ClientContext* context) {
  v1::WatchGraphRequest request;
  request.set_map(map_);
  {
    absl::MutexLock lock(&mutex_);
    request.set_after_revision(books_.revision);
    request.set_map_epoch(books_.map_epoch);
  }
  const auto stream = stub_->WatchGraph(context, request);
  v1::WatchGraphResponse frame;
  for (int64_t frames = 0; stream->Read(&frame); ++frames) {
    absl::MutexLock lock(&mutex_);
    books_.streams += frames == 0;
    Take(frame);
  }
  stream->Finish();
}

void RevisionWatcher::Take(const v1::WatchGraphResponse& frame) {
  mutex_.AssertHeld();
  const v1::Graph& graph = frame.has_delta() ? frame.delta().changes() : frame.snapshot();
  const bool heartbeat = frame.has_heartbeat();
  const uint64_t epoch = heartbeat ? frame.heartbeat().map_epoch() : graph.map_epoch();
  const uint64_t revision = heartbeat ? frame.heartbeat().revision() : graph.revision();
  if (books_.map_epoch == 0) books_.map_epoch = epoch;
  books_.other_epochs += epoch != books_.map_epoch;
  books_.went_back += heartbeat ? revision < books_.revision : revision <= books_.revision;
  if (heartbeat) return;
  books_.wrong_deltas += frame.has_delta() && frame.delta().base_revision() != books_.revision;
  books_.revision = revision;
  ++books_.graphs;
}

}  // namespace overtone
