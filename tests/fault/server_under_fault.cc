// SPDX-License-Identifier: Apache-2.0
#include "overtone/tests/fault/server_under_fault.h"

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "grpcpp/create_channel.h"
#include "grpcpp/security/credentials.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/v1/mapping_service.grpc.pb.h"

namespace overtone {
namespace {

// Below the range that the kernel takes for outgoing connections: a client that looks for a dead
// server there could be given that very port and talk to itself.
constexpr int kFirstPort = 20000, kPorts = 12000;

bool IsFree(int port) {
  const int fd = socket(AF_INET, SOCK_STREAM, 0);
  const int on = 1;
  setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &on, sizeof(on));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<uint16_t>(port));
  const bool free = bind(fd, reinterpret_cast<sockaddr*>(&address), sizeof(address)) == 0;
  close(fd);
  return free;
}

int FreePort() {
  static int tried = 0;
  while (tried < kPorts) {
    const int port = kFirstPort + (getpid() * 37 + tried++) % kPorts;
    if (IsFree(port)) return port;
  }
  std::abort();
}

// A channel that tries again at once: what is measured is the server.
std::shared_ptr<grpc::Channel> EagerChannel(const std::string& address) {
  grpc::ChannelArguments arguments;
  arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, 5);
  arguments.SetInt(GRPC_ARG_MIN_RECONNECT_BACKOFF_MS, 1000);
  arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, 5);
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  return grpc::CreateCustomChannel(address, grpc::InsecureChannelCredentials(), arguments);
}

}  // namespace

ServerUnderFault::ServerUnderFault(std::string directory, const std::string& options)
    : directory_(std::move(directory)), port_(FreePort()) {
  std::ofstream(directory_ + "/server.yaml")
      << "listen: " << address() << "\ndata_dir: " << data_dir() << "\n"
      << options;
}

std::string ServerUnderFault::address() const { return absl::StrCat("127.0.0.1:", port_); }

absl::Status ServerUnderFault::Spawn(const std::string& failpoint) {
  ChildProcessOptions options;
  options.name = "mapping server";
  options.stderr_path = log_path();
  if (!failpoint.empty()) options.arguments = {"env", "OVERTONE_FAILPOINT=" + failpoint};
  for (const char* argument : {OVERTONE_SERVER, "--config"}) options.arguments.push_back(argument);
  options.arguments.push_back(directory_ + "/server.yaml");
  ASSIGN_OR_RETURN(process_, ChildProcess::Start(std::move(options)));
  return absl::OkStatus();
}

absl::Status ServerUnderFault::AwaitServing(absl::Duration timeout) {
  RETURN_IF_ERROR(process_->ReadLine(timeout, [] { return absl::OkStatus(); }).status());
  const auto stub = v1::MappingService::NewStub(EagerChannel(address()));
  grpc::ClientContext context;
  context.set_wait_for_ready(true);
  context.set_deadline(absl::ToChronoTime(absl::Now() + timeout));
  v1::GetServerInfoResponse response;
  const grpc::Status status = stub->GetServerInfo(&context, {}, &response);
  if (status.ok()) return absl::OkStatus();
  RETURN_IF_ERROR(process_->CheckAlive(absl::Seconds(1)));
  return absl::DeadlineExceededError(status.error_message());
}

absl::Status ServerUnderFault::Start(const std::string& failpoint) {
  RETURN_IF_ERROR(Spawn(failpoint));
  return AwaitServing();
}

void ServerUnderFault::Kill() {
  if (process_->CheckAlive().ok()) kill(process_->pid(), SIGKILL);
  process_->CheckAlive(absl::InfiniteDuration()).IgnoreError();
}

void ServerUnderFault::Terminate() { kill(process_->pid(), SIGTERM); }

bool ServerUnderFault::AwaitEnd(absl::Duration timeout) {
  return !process_->CheckAlive(timeout).ok();
}

}  // namespace overtone
