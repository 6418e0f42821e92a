// SPDX-License-Identifier: Apache-2.0
#include "overtone/tests/support/cutting_proxy.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace overtone {
namespace {

sockaddr_in Loopback(int port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<uint16_t>(port));
  return address;
}

int Connect(const std::string& server) {
  const sockaddr_in address = Loopback(std::stoi(server.substr(server.rfind(':') + 1)));
  const int fd = socket(AF_INET, SOCK_STREAM, 0);
  if (connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0) return fd;
  close(fd);
  return -1;
}

// What there is to read, at most 64 KiB. 0: the end.
int64_t Pass(int from, int to) {
  char buffer[1 << 16];
  const ssize_t size = recv(from, buffer, sizeof(buffer), 0);
  for (ssize_t sent = 0; sent < size;) {
    const ssize_t now = send(to, buffer + sent, static_cast<size_t>(size - sent), MSG_NOSIGNAL);
    if (now <= 0) return 0;
    sent += now;
  }
  return size > 0 ? size : 0;
}

}  // namespace

CuttingProxy::CuttingProxy(const std::string& server, int64_t cut_after_bytes)
    : server_(server), cut_after_bytes_(cut_after_bytes) {
  sockaddr_in address = Loopback(0);
  socklen_t length = sizeof(address);
  listener_ = socket(AF_INET, SOCK_STREAM, 0);
  if (pipe(stop_) == 0 && bind(listener_, reinterpret_cast<sockaddr*>(&address), length) == 0 &&
      listen(listener_, /*backlog=*/16) == 0 &&
      getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &length) == 0) {
    port_ = ntohs(address.sin_port);
  }
  thread_ = std::thread([this] { Run(); });
}

CuttingProxy::~CuttingProxy() {
  close(stop_[1]);
  thread_.join();
  close(stop_[0]);
  close(listener_);
}

std::string CuttingProxy::address() const { return "127.0.0.1:" + std::to_string(port_); }

void CuttingProxy::Run() {
  while (true) {
    pollfd fds[] = {{stop_[0], POLLIN, 0}, {listener_, POLLIN, 0}};
    if (poll(fds, 2, -1) < 0 || fds[0].revents != 0) return;
    const int client = accept(listener_, nullptr, nullptr);
    if (client < 0) continue;
    const int server = Connect(server_);
    if (server >= 0) {
      Forward(client, server, connections_++ == 0 ? cut_after_bytes_ : 0);
      close(server);
    }
    close(client);
  }
}

void CuttingProxy::Forward(int client, int server, int64_t limit) {
  int64_t sent = 0;
  while (limit == 0 || sent < limit) {
    pollfd fds[] = {{stop_[0], POLLIN, 0}, {client, POLLIN, 0}, {server, POLLIN, 0}};
    if (poll(fds, 3, -1) < 0 || fds[0].revents != 0) return;
    if (fds[1].revents != 0) {
      const int64_t size = Pass(client, server);
      if (size == 0) return;
      sent += size;
    }
    if (fds[2].revents != 0 && Pass(server, client) == 0) return;
  }
}

}  // namespace overtone
