// SPDX-License-Identifier: Apache-2.0
// A radio link between a robot and a server on the loopback interface, as a TCP proxy whose
// conditions the test changes at any time.
#ifndef OVERTONE_TESTS_SUPPORT_FAULTY_LINK_H_
#define OVERTONE_TESTS_SUPPORT_FAULTY_LINK_H_

#include <atomic>
#include <cstdint>
#include <list>
#include <memory>
#include <random>
#include <string>
#include <thread>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"

namespace overtone {

struct LinkConditions {
  // New connections are reset at once: nobody listens there.
  bool refuse = false;
  // Connections are taken, and nothing is forwarded either way: half-open. What was sent meanwhile
  // arrives when it is over.
  bool black_hole = false;
  absl::Duration latency;        // each way
  int64_t bytes_per_second = 0;  // each way, of all connections together; 0: no limit
  // Of TCP segments. A lost one arrives after retransmission, and all behind it wait for that.
  double loss = 0;
  // Every connection is reset when so many bytes have gone up; 0: never.
  int64_t reset_after_bytes = 0;
};

// Thread-safe.
class FaultyLink {
 public:
  explicit FaultyLink(const std::string& server, uint64_t seed = 1);  // "127.0.0.1:port"
  ~FaultyLink();

  std::string address() const;

  void Set(const LinkConditions& conditions);
  // Resets the connections that there are.
  void Cut();

  int64_t connections() const { return connections_; }  // to the server
  int64_t bytes_up() const { return bytes_up_; }        // delivered to the server
  int64_t bytes_down() const { return bytes_down_; }

 private:
  struct Connection;

  void Run();
  void Wake();
  void Accept(const LinkConditions& conditions);
  bool ConnectToServer(Connection& connection);
  // False: it is over.
  bool Move(Connection& connection, const LinkConditions& conditions, absl::Time now);

  const std::string server_;
  int listener_ = -1;
  int wake_[2] = {-1, -1};  // a pipe: readable when there is news for the thread
  int port_ = 0;
  std::mt19937_64 random_;                       // of the thread
  std::list<std::unique_ptr<Connection>> open_;  // likewise
  absl::Time up_free_at_, down_free_at_;         // likewise; of the limited rate
  absl::Mutex mutex_;
  LinkConditions conditions_ ABSL_GUARDED_BY(mutex_);
  bool cut_ ABSL_GUARDED_BY(mutex_) = false;
  bool stopping_ ABSL_GUARDED_BY(mutex_) = false;
  std::atomic<int64_t> connections_{0}, bytes_up_{0}, bytes_down_{0};
  std::thread thread_;
};

}  // namespace overtone

#endif  // OVERTONE_TESTS_SUPPORT_FAULTY_LINK_H_
