// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/mapping_server.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "grpc/health/v1/health.pb.h"
#include "grpcpp/ext/proto_server_reflection_plugin.h"
#include "grpcpp/health_check_service_interface.h"
#include "grpcpp/impl/server_builder_option.h"
#include "grpcpp/impl/server_builder_plugin.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/limits.h"
#include "overtone/services/mapping_server/rpc/call_interceptor.h"
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

int Milliseconds(double seconds) { return static_cast<int>(1000 * seconds); }

void ConfigureConnections(const ServerOptions& options, grpc::ServerBuilder& builder) {
  const int keepalive_ms = Milliseconds(options.keepalive_s);
  builder.SetMaxReceiveMessageSize(static_cast<int>(limits::kMaxRequestBytes));
  builder.SetMaxSendMessageSize(static_cast<int>(options.limits.max_message_bytes));
  builder.AddChannelArgument(GRPC_ARG_MAX_CONCURRENT_STREAMS,
                             options.limits.max_concurrent_streams);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIME_MS, keepalive_ms);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, keepalive_ms);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MAX_PINGS_WITHOUT_DATA, 0);
  if (options.limits.max_connection_age_s > 0) {
    const double age_s = options.limits.max_connection_age_s;
    builder.AddChannelArgument(GRPC_ARG_MAX_CONNECTION_AGE_MS, Milliseconds(age_s));
    // The youngest of its streams has as long to end itself.
    builder.AddChannelArgument(GRPC_ARG_MAX_CONNECTION_AGE_GRACE_MS, Milliseconds(age_s + 10));
  }
  // Robots ping too, on idle links as well.
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_PERMIT_WITHOUT_CALLS, 1);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MIN_RECV_PING_INTERVAL_WITHOUT_DATA_MS, 1000);
  // Two servers must not share a port silently.
  builder.AddChannelArgument(GRPC_ARG_ALLOW_REUSEPORT, 0);
}

}  // namespace

MappingServer::MappingServer(const Configuration& configuration,
                             std::unique_ptr<ServerSecurity> security)
    : options_(configuration.options),
      security_(std::move(security)),
      quotas_(options_.quotas),
      registry_(options_),
      maintenance_(options_.limits, &registry_, &sessions_),
      mapping_service_(options_, security_->access(), &quotas_, &registry_, &sessions_),
      map_admin_service_(options_.limits.max_message_bytes, DescribeConfiguration(configuration),
                         security_->access(), &registry_, &sessions_, &maintenance_) {}

absl::StatusOr<std::unique_ptr<MappingServer>> MappingServer::Start(const ServerOptions& options,
                                                                    const OptionSources& sources) {
  RETURN_IF_ERROR(options.Validate());
  ASSIGN_OR_RETURN(std::unique_ptr<ServerSecurity> security,
                   ServerSecurity::Create(options.security));
  std::unique_ptr<MappingServer> server(new MappingServer({options, sources}, std::move(security)));
  RETURN_IF_ERROR(server->registry_.Open());
  RETURN_IF_ERROR(server->Listen());
  if (!options.metrics_listen.empty()) {
    ASSIGN_OR_RETURN(
        server->metrics_,
        MetricsEndpoint::Start(options.metrics_listen, {&server->registry_, &server->sessions_,
                                                        &server->quotas_, &server->rpcs_}));
  }
  return server;
}

absl::Status MappingServer::Listen() {
  grpc::EnableDefaultHealthCheckService(true);
  grpc::reflection::InitProtoReflectionServerBuilderPlugin();
  grpc::health::v1::HealthCheckRequest::descriptor();  // linked, so that reflection knows it
  grpc::ServerBuilder builder;
  ConfigureConnections(options_, builder);
  if (!options_.reflection) builder.SetOption(std::make_unique<WithoutReflection>());
  builder.AddListeningPort(options_.listen, security_->Credentials(), &port_);
  std::vector<std::unique_ptr<grpc::experimental::ServerInterceptorFactoryInterface>> interceptors;
  interceptors.push_back(std::make_unique<CallInterceptorFactory>(&rpcs_));
  builder.experimental().SetInterceptorCreators(std::move(interceptors));
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
  const absl::Time end = absl::Now() + deadline;
  metrics_.reset();
  server_->GetHealthCheckService()->Shutdown();  // load balancers look elsewhere
  maintenance_.Stop();
  sessions_.Stop();
  registry_.Stop();
  server_->Shutdown(absl::ToChronoTime(end));
  server_->Wait();
  server_.reset();
}

}  // namespace overtone
