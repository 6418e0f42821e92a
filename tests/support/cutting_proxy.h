// SPDX-License-Identifier: Apache-2.0
// A link that breaks: forwards TCP connections to a server on the loopback interface, one after
// the other, and cuts the first of them once so many bytes have gone up.
#ifndef OVERTONE_TESTS_SUPPORT_CUTTING_PROXY_H_
#define OVERTONE_TESTS_SUPPORT_CUTTING_PROXY_H_

#include <atomic>
#include <cstdint>
#include <string>
#include <thread>

namespace overtone {

class CuttingProxy {
 public:
  // `server`: "127.0.0.1:port".
  CuttingProxy(const std::string& server, int64_t cut_after_bytes);
  ~CuttingProxy();

  std::string address() const;
  int connections() const { return connections_; }

 private:
  void Run();
  // Until one end closes, `limit` bytes (0: any number) went from `client` to `server`, or we stop.
  void Forward(int client, int server, int64_t limit);

  const std::string server_;
  const int64_t cut_after_bytes_;
  int listener_ = -1;
  int stop_[2] = {-1, -1};  // a pipe: readable when we stop
  int port_ = 0;
  std::atomic<int> connections_{0};
  std::thread thread_;
};

}  // namespace overtone

#endif  // OVERTONE_TESTS_SUPPORT_CUTTING_PROXY_H_
