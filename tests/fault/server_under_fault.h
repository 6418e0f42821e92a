// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_TESTS_FAULT_SERVER_UNDER_FAULT_H_
#define OVERTONE_TESTS_FAULT_SERVER_UNDER_FAULT_H_

#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/time/time.h"
#include "overtone/client/cli/child_process.h"

namespace overtone {

// The mapping server's process, ended and started again on one port and one data directory. Its log
// is appended to `directory`/server.log. Not thread-safe.
class ServerUnderFault {
 public:
  // `options`: more lines of its configuration file.
  explicit ServerUnderFault(std::string directory, const std::string& options = "");

  std::string address() const;  // the same for all its lives
  std::string data_dir() const { return directory_ + "/data"; }
  std::string log_path() const { return directory_ + "/server.log"; }

  // `failpoint`: name:count (services/mapping_server/failpoint.h). Does not wait.
  absl::Status Spawn(const std::string& failpoint = "");
  // Until it answers a call. Unavailable: it ended first.
  absl::Status AwaitServing(absl::Duration timeout = absl::Seconds(60));
  absl::Status Start(const std::string& failpoint = "");

  // SIGKILL; it has ended when this returns.
  void Kill();
  // SIGTERM only.
  void Terminate();
  // True: it ended within `timeout`.
  bool AwaitEnd(absl::Duration timeout);
  // How it ended: ok for exit code 0.
  absl::Status Ending() { return process_->Terminate(absl::ZeroDuration()); }
  pid_t pid() const { return process_->pid(); }

 private:
  std::string directory_;
  int port_;
  std::unique_ptr<ChildProcess> process_;
};

}  // namespace overtone

#endif  // OVERTONE_TESTS_FAULT_SERVER_UNDER_FAULT_H_
