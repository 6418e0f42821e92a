// SPDX-License-Identifier: Apache-2.0
#include "overtone/tests/support/faulty_link.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "absl/time/clock.h"
#include "overtone/tests/support/link_direction.h"

namespace overtone {
namespace {

sockaddr_in Loopback(int port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<uint16_t>(port));
  return address;
}

// With a reset: the peer learns at once, and what was under way is lost.
void Reset(int fd) {
  const linger hard{1, 0};
  setsockopt(fd, SOL_SOCKET, SO_LINGER, &hard, sizeof(hard));
  close(fd);
}

// Small buffers: what a sender believes to be under way is, and not in the kernel's memory.
void Tune(int fd) {
  const int on = 1, buffer_bytes = 1 << 15;
  setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on));
  setsockopt(fd, SOL_SOCKET, SO_SNDBUF, &buffer_bytes, sizeof(buffer_bytes));
}

}  // namespace

struct FaultyLink::Connection {
  explicit Connection(int client) : client(client) {}
  ~Connection() {
    Reset(client);
    if (server >= 0) Reset(server);
  }

  const int client;
  int server = -1;  // -1: not yet, in a black hole
  int64_t bytes_up = 0;
  std::unique_ptr<LinkDirection> up, down;
};

FaultyLink::FaultyLink(const std::string& server, uint64_t seed) : server_(server), random_(seed) {
  sockaddr_in address = Loopback(0);
  socklen_t length = sizeof(address);
  const int buffer_bytes = 1 << 15;
  listener_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  setsockopt(listener_, SOL_SOCKET, SO_RCVBUF, &buffer_bytes, sizeof(buffer_bytes));
  if (pipe2(wake_, O_CLOEXEC | O_NONBLOCK) == 0 &&
      bind(listener_, reinterpret_cast<sockaddr*>(&address), length) == 0 &&
      listen(listener_, /*backlog=*/16) == 0 &&
      getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &length) == 0) {
    port_ = ntohs(address.sin_port);
  }
  thread_ = std::thread([this] { Run(); });
}

FaultyLink::~FaultyLink() {
  {
    absl::MutexLock lock(&mutex_);
    stopping_ = true;
  }
  Wake();
  thread_.join();
  for (const int fd : {wake_[0], wake_[1], listener_}) close(fd);
}

std::string FaultyLink::address() const { return "127.0.0.1:" + std::to_string(port_); }

void FaultyLink::Set(const LinkConditions& conditions) {
  {
    absl::MutexLock lock(&mutex_);
    conditions_ = conditions;
  }
  Wake();
}

void FaultyLink::Cut() {
  {
    absl::MutexLock lock(&mutex_);
    cut_ = true;
  }
  Wake();
}

void FaultyLink::Wake() { [[maybe_unused]] const ssize_t written = write(wake_[1], "", 1); }

void FaultyLink::Run() {
  while (true) {
    LinkConditions conditions;
    {
      absl::MutexLock lock(&mutex_);
      if (stopping_) break;
      conditions = conditions_;
      if (std::exchange(cut_, false)) open_.clear();
    }
    absl::Time now = absl::Now();
    std::vector<pollfd> fds = {{wake_[0], POLLIN, 0}, {listener_, POLLIN, 0}};
    absl::Time wake = absl::InfiniteFuture();
    for (const auto& connection : open_) {
      if (conditions.black_hole || connection->up == nullptr) continue;
      for (const auto& [way, from, to] :
           {std::tuple(connection->up.get(), connection->client, connection->server),
            std::tuple(connection->down.get(), connection->server, connection->client)}) {
        if (way->WantsToRead(conditions)) fds.push_back({from, POLLIN, 0});
        if (way->WantsToWrite(now)) fds.push_back({to, POLLOUT, 0});
        wake = std::min(wake, way->NextDue() > now ? way->NextDue() : absl::InfiniteFuture());
      }
    }
    const int wait_ms = wake == absl::InfiniteFuture()
                            ? -1
                            : static_cast<int>(absl::ToInt64Milliseconds(wake - now)) + 1;
    poll(fds.data(), fds.size(), wait_ms);
    char drained[64];
    while (read(wake_[0], drained, sizeof(drained)) > 0) {
    }
    if (fds[1].revents != 0) Accept(conditions);
    now = absl::Now();
    open_.remove_if([&](const auto& connection) { return !Move(*connection, conditions, now); });
  }
  open_.clear();
}

void FaultyLink::Accept(const LinkConditions& conditions) {
  const int client = accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
  if (client < 0) return;
  Tune(client);
  auto connection = std::make_unique<Connection>(client);  // refused: reset as it goes
  if (!conditions.refuse) open_.push_back(std::move(connection));
}

bool FaultyLink::ConnectToServer(Connection& connection) {
  const sockaddr_in address = Loopback(std::stoi(server_.substr(server_.rfind(':') + 1)));
  connection.server = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  Tune(connection.server);
  if (connect(connection.server, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) !=
      0) {
    return false;
  }
  ++connections_;
  connection.up = std::make_unique<LinkDirection>(connection.client, connection.server);
  connection.down = std::make_unique<LinkDirection>(connection.server, connection.client);
  return true;
}

bool FaultyLink::Move(Connection& connection, const LinkConditions& conditions, absl::Time now) {
  if (conditions.black_hole) return true;
  if (connection.up == nullptr && !ConnectToServer(connection)) return false;
  if (connection.up->WantsToRead(conditions))
    connection.up->Read(conditions, now, &up_free_at_, &random_);
  if (connection.down->WantsToRead(conditions)) {
    connection.down->Read(conditions, now, &down_free_at_, &random_);
  }
  const int64_t limit = conditions.reset_after_bytes > 0
                            ? conditions.reset_after_bytes - connection.bytes_up
                            : std::numeric_limits<int64_t>::max();
  const int64_t up = connection.up->Write(now, limit);
  const int64_t down = connection.down->Write(now, std::numeric_limits<int64_t>::max());
  if (up < 0 || down < 0) return false;
  connection.bytes_up += up;
  bytes_up_ += up;
  bytes_down_ += down;
  return up < limit && !connection.up->Finished() && !connection.down->Finished();
}

}  // namespace overtone
