// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdint>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include "overtone/services/mapping_server/metrics/collectors.h"

namespace overtone {
namespace {

void CollectMethod(const MethodMetrics& method, MetricSet& set) {
  set.Add("overtone_rpc_started_total", {method.name}, static_cast<double>(method.started));
  set.Add("overtone_rpc_in_progress", {method.name}, static_cast<double>(method.in_progress));
  for (int code = 0; code < kStatusCodes; ++code) {
    const Histogram<14>& duration = method.duration_s[static_cast<size_t>(code)];
    const std::vector<uint64_t> counts = duration.Counts();
    const uint64_t handled = std::accumulate(counts.begin(), counts.end(), uint64_t{0});
    // 17 codes of 25 methods, most of which never happen: a series begins with its first call.
    if (handled == 0) continue;
    const std::string name = CodeName(static_cast<grpc::StatusCode>(code));
    set.Add("overtone_rpc_handled_total", {method.name, name}, static_cast<double>(handled));
    set.Add("overtone_rpc_duration_seconds", {method.name, name}, duration);
  }
}

}  // namespace

void CollectRpcs(const RpcMetrics& rpcs, MetricSet& set) {
  for (const std::unique_ptr<MethodMetrics>& method : rpcs.methods()) CollectMethod(*method, set);
}

void CollectQuotas(const RobotQuotas::Refusals& refusals, MetricSet& set) {
  const auto add = [&set](const char* kind, int64_t count) {
    set.Add("overtone_quota_refusals_total", {kind}, static_cast<double>(count));
  };
  add("calls", refusals.calls);
  add("streams", refusals.streams);
  add("uploads", refusals.uploads);
}

}  // namespace overtone
