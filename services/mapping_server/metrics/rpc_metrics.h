// SPDX-License-Identifier: Apache-2.0
// How many calls came, how they ended and how long they took.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_METRICS_RPC_METRICS_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_METRICS_RPC_METRICS_H_

#include <array>
#include <atomic>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "absl/strings/string_view.h"
#include "grpcpp/support/status.h"
#include "overtone/services/mapping_server/metrics/histogram.h"

namespace overtone {

// From a look-up in memory to a stream that is open for hours.
constexpr std::array<double, 14> kRpcBoundsS = {0.0005, 0.001, 0.0025, 0.005, 0.01, 0.025, 0.05,
                                                0.1,    0.25,  1,      5,     30,   300,   3600};
constexpr int kStatusCodes = 17;

// One method. Thread-safe.
struct MethodMetrics {
  explicit MethodMetrics(std::string method_name);

  std::string name;  // "MappingService/GetGraph"
  std::atomic<int64_t> started{0};
  std::atomic<int64_t> in_progress{0};
  std::deque<Histogram<14>> duration_s;  // by status code
};

// Thread-safe: the set of methods does not change.
class RpcMetrics {
 public:
  // All of MappingService and MapAdminService, and one "other" for the rest (health, reflection).
  RpcMetrics();

  // `path`: "/overtone.v1.MappingService/GetGraph".
  MethodMetrics& Of(absl::string_view path);
  const std::vector<std::unique_ptr<MethodMetrics>>& methods() const { return methods_; }

 private:
  std::vector<std::unique_ptr<MethodMetrics>> methods_;  // back: "other"
  std::map<std::string, MethodMetrics*, std::less<>> by_path_;
};

// "OK", "NOT_FOUND", ...; a code that is none of the 17: "UNKNOWN".
std::string CodeName(grpc::StatusCode code);

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_METRICS_RPC_METRICS_H_
