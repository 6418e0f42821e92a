// SPDX-License-Identifier: Apache-2.0
// A mapping server of our own, on a free port, for as long as a replay lasts.
#ifndef OVERTONE_CLIENT_CLI_SERVER_PROCESS_H_
#define OVERTONE_CLIENT_CLI_SERVER_PROCESS_H_

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "overtone/client/cli/child_process.h"

namespace overtone {

// overtone-mapping-server next to this program, else in its place of the build tree, else as found
// in PATH.
std::string FindServerProgram();

class ServerProcess {
 public:
  // Starts `program --listen 127.0.0.1:0`, which keeps nothing unless `arguments` hold a
  // --data-dir, and waits until it says where it listens. Its log goes to `log_path`.
  static absl::StatusOr<std::unique_ptr<ServerProcess>> Start(
      const std::string& program, const std::vector<std::string>& arguments,
      const std::string& log_path, const std::function<absl::Status()>& interrupted);

  const std::string& address() const { return address_; }  // host:port
  pid_t pid() const { return process_->pid(); }

  // Unavailable saying how it ended and where its log is.
  absl::Status CheckAlive(absl::Duration wait = absl::ZeroDuration());

  // Asks it to shut down and waits; not ok when it did not end with code 0.
  absl::Status Stop();

 private:
  ServerProcess(std::unique_ptr<ChildProcess> process, std::string address, std::string log_path);

  std::unique_ptr<ChildProcess> process_;
  std::string address_;
  std::string log_path_;
};

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_SERVER_PROCESS_H_
