// SPDX-License-Identifier: Apache-2.0
// A mapping server in a process of its own, for peers that do it harm.
#ifndef OVERTONE_TESTS_FAULT_FAULT_SERVER_H_
#define OVERTONE_TESTS_FAULT_FAULT_SERVER_H_

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "grpcpp/grpcpp.h"
#include "gtest/gtest.h"
#include "overtone/client/cli/server_process.h"
#include "overtone/v1/mapping_service.grpc.pb.h"

namespace overtone::testing {

// Keeps its maps in a folder of its own, which goes with it.
class FaultServer {
 public:
  FaultServer(const std::string& name, const std::string& yaml)
      : folder_(absl::StrCat(::testing::TempDir(), name, "_", getpid())) {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    std::ofstream(folder_ + "/server.yaml") << yaml;
    Start();
  }
  ~FaultServer() {
    process_.reset();
    std::filesystem::remove_all(folder_);
  }

  void Start() {
    auto process = ServerProcess::Start(
        OVERTONE_SERVER, {"--config", folder_ + "/server.yaml", "--data-dir", folder_ + "/data"},
        folder_ + "/log", [] { return absl::OkStatus(); });
    ASSERT_TRUE(process.ok()) << process.status();
    process_ = *std::move(process);
  }
  ServerProcess& process() { return *process_; }

  // On a connection of its own.
  std::unique_ptr<v1::MappingService::Stub> Connect() const {
    grpc::ChannelArguments arguments;
    arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
    return v1::MappingService::NewStub(grpc::CreateCustomChannel(
        process_->address(), grpc::InsecureChannelCredentials(), arguments));
  }

  // Of the process, now and at most so far, MiB.
  double ResidentMebibytes() const { return Mebibytes("VmRSS:"); }
  double PeakMebibytes() const { return Mebibytes("VmHWM:"); }

 private:
  double Mebibytes(const std::string& name) const {
    std::ifstream status(absl::StrCat("/proc/", process_->pid(), "/status"));
    std::string word;
    while (status >> word && word != name) {
    }
    double kibibytes = 0;
    status >> kibibytes;
    return kibibytes / 1024;
  }

  const std::string folder_;
  std::unique_ptr<ServerProcess> process_;
};

}  // namespace overtone::testing

#endif  // OVERTONE_TESTS_FAULT_FAULT_SERVER_H_
