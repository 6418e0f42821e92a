// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_MAPPING_SERVER_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_MAPPING_SERVER_H_

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "grpcpp/grpcpp.h"
#include "overtone/services/mapping_server/configuration.h"
#include "overtone/services/mapping_server/map_admin_service.h"
#include "overtone/services/mapping_server/map_maintenance.h"
#include "overtone/services/mapping_server/map_registry.h"
#include "overtone/services/mapping_server/mapping_service.h"
#include "overtone/services/mapping_server/metrics.h"
#include "overtone/services/mapping_server/metrics/rpc_metrics.h"
#include "overtone/services/mapping_server/quota/robot_quotas.h"
#include "overtone/services/mapping_server/security/server_security.h"
#include "overtone/services/mapping_server/server_options.h"
#include "overtone/services/mapping_server/upload_sessions.h"

namespace overtone {

// The whole server in one object; the binary and the tests both start it this way.
class MappingServer {
 public:
  // Serves when this returns. `sources`: who set the options, for operators. InvalidArgument naming
  // the option; Unavailable: the address cannot be listened on.
  static absl::StatusOr<std::unique_ptr<MappingServer>> Start(
      const ServerOptions& options, const OptionSources& sources = OptionSources());
  // As Shutdown with options.shutdown_s.
  ~MappingServer();

  int port() const { return port_; }
  // Of the metrics; 0 when there are none.
  int metrics_port() const { return metrics_ == nullptr ? 0 : metrics_->port(); }
  // host:port, with the port that was taken.
  std::string address() const;

  // Looks at certificates and access rules now; see ServerSecurity::Reload.
  void ReloadSecurity() { security_->Reload(); }

  // Says NOT_SERVING, ends the streams with UNAVAILABLE once what they sent is acknowledged, lets
  // calls finish until `deadline` has passed, then cancels what is left. An operator's work on a
  // whole map is finished. Calling it again does nothing.
  void Shutdown(absl::Duration deadline);

 private:
  MappingServer(const Configuration& configuration, std::unique_ptr<ServerSecurity> security);
  absl::Status Listen();

  const ServerOptions options_;
  const std::unique_ptr<ServerSecurity> security_;
  RobotQuotas quotas_;
  RpcMetrics rpcs_;
  MapRegistry registry_;
  UploadSessions sessions_;
  MapMaintenance maintenance_;
  MappingService mapping_service_;
  MapAdminService map_admin_service_;
  std::unique_ptr<MetricsEndpoint> metrics_;
  int port_ = 0;
  std::unique_ptr<grpc::Server> server_;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_MAPPING_SERVER_H_
