// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/mapping_server.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "grpcpp/ext/proto_server_reflection_plugin.h"
#include "grpcpp/health_check_service_interface.h"
#include "grpcpp/impl/server_builder_option.h"
#include "grpcpp/impl/server_builder_plugin.h"
#include "overtone/core/common/status_macros.h"
#include "spdlog/spdlog.h"

namespace overtone {
namespace {

// Linking gRPC's reflection library is enough to switch it on; this switches it off for one server.
class WithoutReflection : public grpc::ServerBuilderOption {
 public:
  void UpdateArguments(grpc::ChannelArguments*) override {}
  void UpdatePlugins(std::vector<std::unique_ptr<grpc::ServerBuilderPlugin>>* plugins) override {
    const auto is_reflection = [](const std::unique_ptr<grpc::ServerBuilderPlugin>& plugin) {
      return plugin->name() == "proto_server_reflection";
    };
    plugins->erase(std::remove_if(plugins->begin(), plugins->end(), is_reflection), plugins->end());
  }
};

void ConfigureConnections(const ServerOptions& options, grpc::ServerBuilder& builder) {
  const int keepalive_ms = static_cast<int>(1000 * options.keepalive_s);
  builder.SetMaxReceiveMessageSize(static_cast<int>(options.limits.max_message_bytes));
  builder.SetMaxSendMessageSize(static_cast<int>(options.limits.max_message_bytes));
  builder.AddChannelArgument(GRPC_ARG_MAX_CONCURRENT_STREAMS,
                             options.limits.max_concurrent_streams);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIME_MS, keepalive_ms);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, keepalive_ms);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MAX_PINGS_WITHOUT_DATA, 0);
  // Robots ping too, on idle links as well.
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_PERMIT_WITHOUT_CALLS, 1);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MIN_RECV_PING_INTERVAL_WITHOUT_DATA_MS, 1000);
  // Two servers must not share a port silently.
  builder.AddChannelArgument(GRPC_ARG_ALLOW_REUSEPORT, 0);
}

}  // namespace

MappingServer::MappingServer(const ServerOptions& options, std::unique_ptr<ServerSecurity> security)
    : options_(options),
      security_(std::move(security)),
      registry_(options),
      maintenance_(options.limits, &registry_, &sessions_),
      mapping_service_(options, security_->access(), &registry_, &sessions_),
      map_admin_service_(options.limits.max_message_bytes, security_->access(), &registry_,
                         &sessions_, &maintenance_) {}

absl::StatusOr<std::unique_ptr<MappingServer>> MappingServer::Start(const ServerOptions& options) {
  RETURN_IF_ERROR(options.Validate());
  ASSIGN_OR_RETURN(std::unique_ptr<ServerSecurity> security,
                   ServerSecurity::Create(options.security));
  std::unique_ptr<MappingServer> server(new MappingServer(options, std::move(security)));
  RETURN_IF_ERROR(server->registry_.Open());
  RETURN_IF_ERROR(server->Listen());
  if (!options.metrics_listen.empty()) {
    ASSIGN_OR_RETURN(server->metrics_,
                     MetricsEndpoint::Start(options.metrics_listen, &server->registry_));
  }
  return server;
}

absl::Status MappingServer::Listen() {
  grpc::EnableDefaultHealthCheckService(true);
  grpc::reflection::InitProtoReflectionServerBuilderPlugin();
  grpc::ServerBuilder builder;
  ConfigureConnections(options_, builder);
  if (!options_.reflection) builder.SetOption(std::make_unique<WithoutReflection>());
  builder.AddListeningPort(options_.listen, security_->Credentials(), &port_);
  builder.RegisterService(&mapping_service_);
  builder.RegisterService(&map_admin_service_);
  server_ = builder.BuildAndStart();
  if (server_ == nullptr || port_ == 0) {
    return absl::UnavailableError(absl::StrCat("listen: cannot listen on ", options_.listen));
  }
  for (const char* service : {"overtone.v1.MappingService", "overtone.v1.MapAdminService"}) {
    server_->GetHealthCheckService()->SetServingStatus(service, true);
  }
  return absl::OkStatus();
}

MappingServer::~MappingServer() { Shutdown(absl::Seconds(options_.shutdown_s)); }

std::string MappingServer::address() const {
  return absl::StrCat(options_.listen.substr(0, options_.listen.rfind(':')), ":", port_);
}

void MappingServer::Shutdown(absl::Duration deadline) {
  if (server_ == nullptr) return;
  spdlog::info("shutting down");
  metrics_.reset();
  server_->GetHealthCheckService()->Shutdown();  // load balancers look elsewhere
  maintenance_.Stop();
  sessions_.Stop();
  registry_.Stop();
  server_->Shutdown(absl::ToChronoTime(absl::Now() + deadline));
  server_->Wait();
  server_.reset();
}

}  // namespace overtone
