// SPDX-License-Identifier: Apache-2.0
// What a Prometheus server reads: the state of every map, gathered when it asks.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_METRICS_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_METRICS_H_

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "overtone/services/mapping_server/map_registry.h"

namespace overtone {

class MetricsEndpoint {
 public:
  // Serves http://<listen>/metrics until it is destroyed. `registry` outlives it. Unavailable: the
  // address cannot be listened on.
  static absl::StatusOr<std::unique_ptr<MetricsEndpoint>> Start(const std::string& listen,
                                                                const MapRegistry* registry);
  ~MetricsEndpoint();

  int port() const;

 private:
  struct Impl;
  explicit MetricsEndpoint(std::unique_ptr<Impl> impl);

  std::unique_ptr<Impl> impl_;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_METRICS_H_
