// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_TESTS_SUPPORT_HTTP_GET_H_
#define OVERTONE_TESTS_SUPPORT_HTTP_GET_H_

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <string>

#include "gtest/gtest.h"

namespace overtone {

// What a server on this host answers, head and body, over a plain socket.
inline std::string HttpGet(int port, const std::string& path) {
  const int connection = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address = {};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  EXPECT_EQ(connect(connection, reinterpret_cast<sockaddr*>(&address), sizeof(address)), 0);
  const std::string request = "GET " + path + " HTTP/1.0\r\n\r\n";
  EXPECT_EQ(send(connection, request.data(), request.size(), MSG_NOSIGNAL),
            static_cast<ssize_t>(request.size()));
  std::string answer;
  std::string part(1 << 16, '\0');
  while (true) {
    const ssize_t size = recv(connection, part.data(), part.size(), 0);
    if (size <= 0) break;
    answer.append(part, 0, static_cast<size_t>(size));
  }
  close(connection);
  return answer;
}

}  // namespace overtone

#endif  // OVERTONE_TESTS_SUPPORT_HTTP_GET_H_
