// SPDX-License-Identifier: Apache-2.0
// What a Prometheus server reads: the state of the server and of every map, gathered when it asks.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_METRICS_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_METRICS_H_

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "overtone/services/mapping_server/map_registry.h"
#include "overtone/services/mapping_server/metrics/rpc_metrics.h"
#include "overtone/services/mapping_server/quota/robot_quotas.h"
#include "overtone/services/mapping_server/upload_sessions.h"

namespace overtone {

// All outlive the endpoint.
struct MetricSources {
  const MapRegistry* registry = nullptr;
  const UploadSessions* sessions = nullptr;
  const RobotQuotas* quotas = nullptr;
  const RpcMetrics* rpcs = nullptr;
};

class MetricsEndpoint {
 public:
  // Serves http://<listen>/metrics until it is destroyed. Unavailable: the address cannot be
  // listened on.
  static absl::StatusOr<std::unique_ptr<MetricsEndpoint>> Start(const std::string& listen,
                                                                const MetricSources& sources);
  ~MetricsEndpoint();

  int port() const;

 private:
  struct Impl;
  explicit MetricsEndpoint(std::unique_ptr<Impl> impl);

  std::unique_ptr<Impl> impl_;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_METRICS_H_
