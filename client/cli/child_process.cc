// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/child_process.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"

namespace overtone {
namespace {

constexpr absl::Duration kPollSlice = absl::Milliseconds(100);

struct Pipe {
  int read = -1;
  int write = -1;
};

// Both ends close on exec; the child duplicates the one it needs.
bool Open(Pipe* pipe) {
  int fds[2];
  if (pipe2(fds, O_CLOEXEC) != 0) return false;
  pipe->read = fds[0];
  pipe->write = fds[1];
  return true;
}

void Close(int* fd) {
  if (*fd >= 0) close(*fd);
  *fd = -1;
}

// The parent's side of a start: everything that must not leak when it fails.
struct Pipes {
  Pipe in, out, failure;  // failure: carries errno when exec fails, closes when it succeeds
  ~Pipes() {
    for (Pipe* pipe : {&in, &out, &failure}) {
      Close(&pipe->read);
      Close(&pipe->write);
    }
  }
};

// Between fork and exec: only async-signal-safe calls, no allocation.
[[noreturn]] void RunChild(const Pipes& pipes, int stderr_fd, char* const argv[], pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(127);  // the parent died before prctl
  setpgid(0, 0);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  signal(SIGPIPE, SIG_DFL);
  dup2(pipes.in.read, STDIN_FILENO);
  dup2(pipes.out.write, STDOUT_FILENO);
  if (stderr_fd >= 0) dup2(stderr_fd, STDERR_FILENO);
  execvp(argv[0], argv);
  const int error = errno;
  [[maybe_unused]] const ssize_t written = write(pipes.failure.write, &error, sizeof(error));
  _exit(127);
}

}  // namespace

absl::StatusOr<std::unique_ptr<ChildProcess>> ChildProcess::Start(ChildProcessOptions options) {
  if (options.arguments.empty()) return absl::InvalidArgumentError("arguments: empty");
  signal(SIGPIPE, SIG_IGN);  // a child that died is an error of ours to report, not our end
  Pipes pipes;
  if (!Open(&pipes.in) || !Open(&pipes.out) || !Open(&pipes.failure)) {
    return absl::ResourceExhaustedError(absl::StrCat("pipe: ", strerror(errno)));
  }
  int stderr_fd = -1;
  if (!options.stderr_path.empty()) {
    stderr_fd = open(options.stderr_path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
    if (stderr_fd < 0) {
      return absl::PermissionDeniedError(
          absl::StrCat("cannot write ", options.stderr_path, ": ", strerror(errno)));
    }
  }
  std::vector<char*> argv;
  for (std::string& argument : options.arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);

  const pid_t parent = getpid();
  const pid_t pid = fork();
  if (pid == 0) RunChild(pipes, stderr_fd, argv.data(), parent);
  Close(&stderr_fd);
  if (pid < 0) return absl::ResourceExhaustedError(absl::StrCat("fork: ", strerror(errno)));
  Close(&pipes.failure.write);
  int error = 0;
  if (read(pipes.failure.read, &error, sizeof(error)) == sizeof(error)) {
    waitpid(pid, nullptr, 0);
    return absl::NotFoundError(
        absl::StrCat("cannot run ", options.arguments[0], ": ", strerror(error)));
  }
  return std::unique_ptr<ChildProcess>(new ChildProcess(std::move(options), pid,
                                                        std::exchange(pipes.in.write, -1),
                                                        std::exchange(pipes.out.read, -1)));
}

ChildProcess::ChildProcess(ChildProcessOptions options, pid_t pid, int stdin_fd, int stdout_fd)
    : options_(std::move(options)), pid_(pid), stdin_fd_(stdin_fd), stdout_fd_(stdout_fd) {}

ChildProcess::~ChildProcess() {
  Terminate(absl::Seconds(5)).IgnoreError();
  Close(&stdin_fd_);
  Close(&stdout_fd_);
}

absl::Status ChildProcess::WriteLine(const std::string& line) {
  const std::string text = line + "\n";
  size_t done = 0;
  while (done < text.size()) {
    const ssize_t count = write(stdin_fd_, text.data() + done, text.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) {
      Reap(absl::Seconds(1));
      return reaped_ ? Ending() : absl::UnavailableError(absl::StrCat(name(), " does not listen"));
    }
    done += count;
  }
  return absl::OkStatus();
}

absl::StatusOr<std::string> ChildProcess::ReadLine(
    absl::Duration timeout, const std::function<absl::Status()>& interrupted) {
  const absl::Time deadline = absl::Now() + timeout;
  size_t searched = 0;
  for (;;) {
    const size_t end = buffer_.find('\n', searched);
    if (end != std::string::npos) {
      std::string line = buffer_.substr(0, end);
      buffer_.erase(0, end + 1);
      return line;
    }
    searched = buffer_.size();
    if (absl::Status status = interrupted(); !status.ok()) return status;
    if (absl::Now() >= deadline) {
      return absl::DeadlineExceededError(
          absl::StrCat("no answer from ", name(), " for ", absl::FormatDuration(timeout)));
    }
    pollfd ready = {stdout_fd_, POLLIN, 0};
    if (poll(&ready, 1, static_cast<int>(absl::ToInt64Milliseconds(kPollSlice))) <= 0) continue;
    char chunk[65536];
    const ssize_t count = read(stdout_fd_, chunk, sizeof(chunk));
    if (count > 0) {
      buffer_.append(chunk, count);
    } else if (count == 0 || errno != EINTR) {  // closed: it has ended, or is about to
      Reap(absl::Seconds(5));
      return reaped_ ? Ending() : absl::UnavailableError(absl::StrCat(name(), " fell silent"));
    }
  }
}

absl::Status ChildProcess::CheckAlive(absl::Duration wait) {
  return Reap(wait) ? Ending() : absl::OkStatus();
}

absl::Status ChildProcess::Terminate(absl::Duration grace) {
  if (!Reap(absl::ZeroDuration())) {
    kill(-pid_, SIGTERM);  // the whole process group: what it started goes with it
    if (!Reap(grace)) {
      kill(-pid_, SIGKILL);
      Reap(absl::InfiniteDuration());
    }
  }
  return WIFEXITED(wait_status_) && WEXITSTATUS(wait_status_) == 0 ? absl::OkStatus() : Ending();
}

bool ChildProcess::Reap(absl::Duration wait) {
  const absl::Time deadline = absl::Now() + wait;
  while (!reaped_) {
    const pid_t ended = waitpid(pid_, &wait_status_, WNOHANG);
    reaped_ = ended == pid_ || (ended < 0 && errno != EINTR);
    if (reaped_ || absl::Now() >= deadline) break;
    // The end of a process as a readable file: no polling, no signal handler.
    const int ending = static_cast<int>(syscall(SYS_pidfd_open, pid_, 0));
    pollfd ready = {ending, POLLIN, 0};
    const absl::Duration left = std::min(deadline - absl::Now(), absl::Seconds(1));
    poll(&ready, ending >= 0 ? 1 : 0, static_cast<int>(absl::ToInt64Milliseconds(left)) + 1);
    if (ending >= 0) close(ending);
  }
  return reaped_;
}

absl::Status ChildProcess::Ending() const {
  if (WIFSIGNALED(wait_status_)) {
    return absl::UnavailableError(
        absl::StrCat(name(), " was ended by signal ", WTERMSIG(wait_status_)));
  }
  return absl::UnavailableError(
      absl::StrCat(name(), " ended with exit code ", WEXITSTATUS(wait_status_)));
}

}  // namespace overtone
