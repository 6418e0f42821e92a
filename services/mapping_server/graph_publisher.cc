// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/graph_publisher.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "overtone/proto/conversion/status_conversion.h"
#include "overtone/services/mapping_server/log_fields.h"
#include "overtone/services/mapping_server/log_limit.h"

namespace overtone {

GraphPublisher::GraphPublisher(const std::string& map, uint64_t map_epoch,
                               const ServerOptions& options)
    : map_(map),
      max_readers_(options.limits.max_watchers_per_map),
      heartbeat_(absl::Seconds(options.publisher.heartbeat_s)),
      frames_(map, map_epoch, options),
      thread_([this] { Run(); }) {}

GraphPublisher::~GraphPublisher() { Stop(); }

void GraphPublisher::Publish(std::shared_ptr<const MapSnapshot> snapshot) {
  absl::MutexLock lock(&mutex_);
  snapshot_ = std::move(snapshot);
}

void GraphPublisher::Subscribe(std::shared_ptr<GraphReader> reader, Subscription subscription) {
  const bool taken = Enqueue([this, reader, subscription = std::move(subscription)] {
    if (readers_.size() >= static_cast<size_t>(max_readers_)) {
      reader->End(absl::ResourceExhaustedError(
          absl::StrCat("map: ", map_, " has ", max_readers_, " watchers already, its limit")));
      return;
    }
    readers_[reader.get()] = {reader, subscription, absl::InfinitePast()};
  });
  if (!taken) reader->End(Stopped());
}

void GraphPublisher::Ready(const GraphReader* reader) {
  Enqueue([this, reader] {
    const auto it = readers_.find(reader);
    if (it != readers_.end()) it->second.ready = true;
  });
}

void GraphPublisher::Unsubscribe(const GraphReader* reader) {
  Enqueue([this, reader] { readers_.erase(reader); });
}

void GraphPublisher::GetNewest(GraphQuery query, GraphEncoding encoding,
                               std::function<void(absl::StatusOr<v1::Graph>)> done) {
  const bool taken = Enqueue(
      [this, query = std::move(query), encoding, done] { done(frames_.Newest(query, encoding)); });
  if (!taken) done(Stopped());
}

void GraphPublisher::Stop(const std::string& why) {
  {
    absl::MutexLock lock(&mutex_);
    if (!stopping_) why_ = why;
    stopping_ = true;
  }
  if (thread_.joinable()) thread_.join();
}

bool GraphPublisher::Enqueue(Command command) {
  absl::MutexLock lock(&mutex_);
  if (stopping_) return false;
  commands_.push_back(std::move(command));
  return true;
}

void GraphPublisher::Run() {
  const LogFields about = LogFieldsOf(map_);
  const LogScope scope(&about);
  std::vector<Command> commands;
  std::shared_ptr<const MapSnapshot> snapshot;
  for (bool more = true; more;) {
    more = TakeWork(commands, snapshot);
    if (snapshot != nullptr) frames_.SetSnapshot(std::move(snapshot));
    for (const Command& command : commands) command();
    if (more) Serve();
  }
  EndReaders();
}

bool GraphPublisher::TakeWork(std::vector<Command>& commands,
                              std::shared_ptr<const MapSnapshot>& snapshot) {
  absl::MutexLock lock(&mutex_);
  const auto something_to_do = [this]() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    return stopping_ || !commands_.empty() || snapshot_ != nullptr;
  };
  mutex_.AwaitWithDeadline(absl::Condition(&something_to_do), next_heartbeat_);
  commands = std::exchange(commands_, {});
  snapshot = std::exchange(snapshot_, nullptr);
  return !stopping_;
}

void GraphPublisher::Serve() {
  const absl::Time now = absl::Now();
  next_heartbeat_ = absl::InfiniteFuture();
  for (auto it = readers_.begin(); it != readers_.end();) {
    it = ServeReader(it->second, now) ? std::next(it) : readers_.erase(it);
  }
}

bool GraphPublisher::ServeReader(Reader& reader, absl::Time now) {
  if (!reader.ready) return true;
  GraphPosition& position = reader.subscription.position;
  const GraphPosition newest = frames_.position();
  const bool behind = newest.revision > 0 && (position.revision != newest.revision ||
                                              position.map_epoch != newest.map_epoch);
  if (behind) {
    const absl::StatusOr<grpc::ByteBuffer> frame =
        frames_.Frame(reader.subscription.query, reader.subscription.encoding, position);
    if (!frame.ok()) {
      LogPeer(spdlog::level::warn, "watch ended", "map {}: a watch ends: {}", map_,
              HeaderSafe(frame.status().ToString()));
      reader.reader->End(frame.status());
      return false;
    }
    position = newest;
    reader.reader->Send(*frame, newest.revision);
  } else if (now >= reader.last_sent + heartbeat_) {
    reader.reader->Send(frames_.Heartbeat(), position.revision);
  } else {
    next_heartbeat_ = std::min(next_heartbeat_, reader.last_sent + heartbeat_);
    return true;
  }
  reader.last_sent = now;
  reader.ready = false;
  return true;
}

absl::Status GraphPublisher::Stopped() {
  absl::MutexLock lock(&mutex_);
  return absl::UnavailableError(why_);
}

void GraphPublisher::EndReaders() {
  const absl::Status stopped = Stopped();
  for (auto& [key, reader] : readers_) reader.reader->End(stopped);
  readers_.clear();
}

}  // namespace overtone
