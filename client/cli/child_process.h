// SPDX-License-Identifier: Apache-2.0
// A child process that is spoken to in lines over pipes, and that never outlives us.
#ifndef OVERTONE_CLIENT_CLI_CHILD_PROCESS_H_
#define OVERTONE_CLIENT_CLI_CHILD_PROCESS_H_

#include <sys/types.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"

namespace overtone {

struct ChildProcessOptions {
  std::string name;                    // for messages, e.g. "robot mh_01"
  std::vector<std::string> arguments;  // [0] is the program's path, or its name in PATH
  std::string stderr_path;             // appended to; empty: our own stderr
};

// Not thread-safe. The kernel ends the child when the thread that started it dies, whatever the
// reason; the child has a process group of its own, so that Ctrl-C reaches only us and we end it in
// good order.
class ChildProcess {
 public:
  // NotFound when the program cannot be run. Safe in a process with other threads: fork and exec,
  // nothing between.
  static absl::StatusOr<std::unique_ptr<ChildProcess>> Start(ChildProcessOptions options);

  // Ends the child: SIGTERM, five seconds, SIGKILL; and reaps it.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  const std::string& name() const { return options_.name; }
  pid_t pid() const { return pid_; }

  // Writes the line and its newline to the child's standard input. Unavailable: the child is gone.
  absl::Status WriteLine(const std::string& line);

  // The next line of its standard output, without the newline. `interrupted` is asked several times
  // a second; its error ends the wait and is returned. Unavailable: the child ended (says how).
  // DeadlineExceeded.
  absl::StatusOr<std::string> ReadLine(absl::Duration timeout,
                                       const std::function<absl::Status()>& interrupted);

  // Ok while it runs; Unavailable saying how it ended, e.g. "robot mh_01 was ended by signal 9".
  // Waits so long for its end: sockets and pipes close a little before.
  absl::Status CheckAlive(absl::Duration wait = absl::ZeroDuration());

  // SIGTERM, and after `grace` SIGKILL. Returns how it ended: ok for exit code 0. Repeated calls
  // return the same.
  absl::Status Terminate(absl::Duration grace);

 private:
  ChildProcess(ChildProcessOptions options, pid_t pid, int stdin_fd, int stdout_fd);

  bool Reap(absl::Duration wait);  // true when it has ended
  absl::Status Ending() const;

  ChildProcessOptions options_;
  pid_t pid_;
  int stdin_fd_;
  int stdout_fd_;
  std::string buffer_;  // read, but not yet handed out
  bool reaped_ = false;
  int wait_status_ = 0;
};

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_CHILD_PROCESS_H_
