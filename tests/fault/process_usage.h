// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_TESTS_FAULT_PROCESS_USAGE_H_
#define OVERTONE_TESTS_FAULT_PROCESS_USAGE_H_

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>

namespace overtone {

// What a process holds, as /proc says. -1: it has ended.
struct ProcessUsage {
  int64_t resident_kb = -1;
  int64_t threads = -1;
  int64_t file_descriptors = -1;
};

inline ProcessUsage UsageOf(pid_t pid) {
  const std::filesystem::path folder = "/proc/" + std::to_string(pid);
  ProcessUsage usage;
  std::ifstream status(folder / "status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind("VmRSS:", 0) == 0) usage.resident_kb = std::stoll(line.substr(6));
    if (line.rfind("Threads:", 0) == 0) usage.threads = std::stoll(line.substr(8));
  }
  std::error_code error;
  std::filesystem::directory_iterator entry(folder / "fd", error);
  if (error) return usage;
  usage.file_descriptors = 0;
  for (; entry != std::filesystem::directory_iterator(); entry.increment(error)) {
    ++usage.file_descriptors;
  }
  return usage;
}

}  // namespace overtone

#endif  // OVERTONE_TESTS_FAULT_PROCESS_USAGE_H_
