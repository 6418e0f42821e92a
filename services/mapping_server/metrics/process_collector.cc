// SPDX-License-Identifier: Apache-2.0
#include <sys/resource.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <system_error>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_split.h"
#include "overtone/services/mapping_server/metrics/collectors.h"

namespace overtone {
namespace {

std::string Slurp(const char* path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

// proc(5): the fields of /proc/self/stat after the command's name, which may hold anything. Its
// first is number 3.
std::vector<std::string> StatFields() {
  const std::string stat = Slurp("/proc/self/stat");
  const size_t end_of_name = stat.rfind(')');
  if (end_of_name == std::string::npos) return {};
  return absl::StrSplit(stat.substr(end_of_name + 1), ' ', absl::SkipWhitespace());
}

double Field(const std::vector<std::string>& fields, size_t number) {
  double value = 0;
  return number - 3 < fields.size() && absl::SimpleAtod(fields[number - 3], &value) ? value : 0;
}

// Seconds since 1970; 0: not known.
double BootTime() {
  std::istringstream lines(Slurp("/proc/stat"));
  std::string word;
  double seconds = 0;
  while (lines >> word) {
    if (word == "btime" && lines >> seconds) return seconds;
  }
  return 0;
}

}  // namespace

void CollectProcess(MetricSet& set) {
  const std::vector<std::string> fields = StatFields();
  const auto ticks = static_cast<double>(sysconf(_SC_CLK_TCK));
  const auto page = static_cast<double>(sysconf(_SC_PAGESIZE));
  if (fields.size() > 21) {
    set.Add("process_cpu_seconds_total", {}, (Field(fields, 14) + Field(fields, 15)) / ticks);
    set.Add("process_virtual_memory_bytes", {}, Field(fields, 23));
    set.Add("process_resident_memory_bytes", {}, Field(fields, 24) * page);
    const double boot = BootTime();
    if (boot > 0) set.Add("process_start_time_seconds", {}, boot + Field(fields, 22) / ticks);
  }
  std::error_code error;
  const std::filesystem::directory_iterator open("/proc/self/fd", error);
  if (!error) {
    // One of them is this look itself.
    set.Add("process_open_fds", {}, static_cast<double>(std::distance(begin(open), end(open)) - 1));
  }
  rlimit limit = {};
  if (getrlimit(RLIMIT_NOFILE, &limit) == 0) {
    set.Add("process_max_fds", {}, static_cast<double>(limit.rlim_cur));
  }
}

void CollectDisk(const std::string& data_dir, MetricSet& set) {
  std::error_code error;
  const std::filesystem::space_info space = std::filesystem::space(data_dir, error);
  if (error) return;
  set.Add("overtone_data_directory_free_bytes", {}, static_cast<double>(space.available));
  set.Add("overtone_data_directory_size_bytes", {}, static_cast<double>(space.capacity));
}

}  // namespace overtone
