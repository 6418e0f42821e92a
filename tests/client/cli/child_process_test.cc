// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/child_process.h"

#include <signal.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace overtone {
namespace {

using ::testing::HasSubstr;

absl::Status NotInterrupted() { return absl::OkStatus(); }

std::unique_ptr<ChildProcess> StartShell(const std::string& script) {
  auto child = ChildProcess::Start({"shell", {"/bin/sh", "-c", script}, ""});
  EXPECT_TRUE(child.ok()) << child.status();
  return child.ok() ? *std::move(child) : nullptr;
}

bool Exists(pid_t pid) { return kill(pid, 0) == 0; }

TEST(ChildProcess, AnswersLineByLine) {
  const auto child = StartShell("while read -r line; do echo \"got $line\"; done");
  ASSERT_NE(child, nullptr);
  for (const char* word : {"one", "two words", ""}) {
    ASSERT_TRUE(child->WriteLine(word).ok());
    const auto line = child->ReadLine(absl::Seconds(20), NotInterrupted);
    ASSERT_TRUE(line.ok()) << line.status();
    EXPECT_EQ(*line, std::string("got ") + word);
  }
}

TEST(ChildProcess, LinesLongerThanAPipeComeWhole) {
  const auto child = StartShell("head -c 300000 /dev/zero | tr '\\0' x; echo; echo end; sleep 60");
  ASSERT_NE(child, nullptr);
  const auto line = child->ReadLine(absl::Seconds(20), NotInterrupted);
  ASSERT_TRUE(line.ok()) << line.status();
  EXPECT_EQ(*line, std::string(300000, 'x'));
  EXPECT_EQ(child->ReadLine(absl::Seconds(20), NotInterrupted).value_or(""), "end");
}

TEST(ChildProcess, AProgramThatIsNotThereIsNamed) {
  const auto child = ChildProcess::Start({"ghost", {"/nowhere/ghost"}, ""});
  EXPECT_EQ(child.status().code(), absl::StatusCode::kNotFound);
  EXPECT_THAT(std::string(child.status().message()), HasSubstr("/nowhere/ghost"));
}

TEST(ChildProcess, SaysWithWhichCodeTheChildEnded) {
  const auto child = StartShell("exit 7");
  ASSERT_NE(child, nullptr);
  const auto line = child->ReadLine(absl::Seconds(20), NotInterrupted);
  EXPECT_EQ(line.status().code(), absl::StatusCode::kUnavailable);
  EXPECT_EQ(line.status().message(), "shell ended with exit code 7");
}

TEST(ChildProcess, SaysWhichSignalEndedTheChild) {
  const auto child = StartShell("kill -9 $$");
  ASSERT_NE(child, nullptr);
  const auto line = child->ReadLine(absl::Seconds(20), NotInterrupted);
  EXPECT_EQ(line.status().message(), "shell was ended by signal 9");
}

TEST(ChildProcess, ASilentChildRunsIntoTheTimeout) {
  const auto child = StartShell("sleep 60");
  ASSERT_NE(child, nullptr);
  const auto line = child->ReadLine(absl::Milliseconds(50), NotInterrupted);
  EXPECT_EQ(line.status().code(), absl::StatusCode::kDeadlineExceeded);
  EXPECT_TRUE(child->CheckAlive().ok());
}

TEST(ChildProcess, AnInterruptEndsTheWait) {
  const auto child = StartShell("sleep 60");
  ASSERT_NE(child, nullptr);
  const auto line =
      child->ReadLine(absl::Seconds(50), [] { return absl::CancelledError("interrupted"); });
  EXPECT_EQ(line.status().code(), absl::StatusCode::kCancelled);
}

TEST(ChildProcess, DestructionEndsAndReapsEvenAChildThatIgnoresTheRequest) {
  auto child = StartShell("trap '' TERM; echo ready; while :; do sleep 1; done");
  ASSERT_NE(child, nullptr);
  ASSERT_TRUE(child->ReadLine(absl::Seconds(20), NotInterrupted).ok());
  const pid_t pid = child->pid();
  ASSERT_TRUE(Exists(pid));
  EXPECT_EQ(child->Terminate(absl::Milliseconds(100)).message(), "shell was ended by signal 9");
  EXPECT_FALSE(Exists(pid));  // not even a zombie
}

TEST(ChildProcess, DiesWithItsParent) {
  int fds[2];
  ASSERT_EQ(pipe(fds), 0);
  const pid_t parent = fork();
  if (parent == 0) {  // a parent that starts a child, tells its pid and dies without cleaning up
    const auto child = ChildProcess::Start({"shell", {"/bin/sh", "-c", "exec sleep 60"}, ""});
    const pid_t pid = child.ok() ? (*child)->pid() : -1;
    if (write(fds[1], &pid, sizeof(pid)) != sizeof(pid)) _exit(1);
    kill(getpid(), SIGKILL);
  }
  pid_t grandchild = -1;
  ASSERT_EQ(read(fds[0], &grandchild, sizeof(grandchild)), sizeof(grandchild));
  ASSERT_GT(grandchild, 0);
  waitpid(parent, nullptr, 0);
  // Its pipes were the last things it held: the read ends when it is gone. Reaped by init, so ask
  // for its state.
  for (int i = 0; i < 1000; ++i) {
    std::ifstream stat("/proc/" + std::to_string(grandchild) + "/stat");
    std::string pid, name, state = "gone";
    stat >> pid >> name >> state;
    if (state == "Z" || state == "gone") return;
    usleep(10000);
  }
  FAIL() << "process " << grandchild << " outlived its parent";
}

TEST(ChildProcess, WritesItsStandardErrorToTheFile) {
  const std::string path = ::testing::TempDir() + "child_stderr_" + std::to_string(getpid());
  auto child = ChildProcess::Start({"shell", {"/bin/sh", "-c", "echo trouble >&2"}, path});
  ASSERT_TRUE(child.ok());
  EXPECT_FALSE((*child)->ReadLine(absl::Seconds(20), NotInterrupted).ok());  // ends
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  EXPECT_EQ(line, "trouble");
  unlink(path.c_str());
}

}  // namespace
}  // namespace overtone
