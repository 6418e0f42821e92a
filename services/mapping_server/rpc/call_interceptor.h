// SPDX-License-Identifier: Apache-2.0
// What every call has in common: a request id, a place in the metrics, and a line in the log when
// it is refused.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_RPC_CALL_INTERCEPTOR_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_RPC_CALL_INTERCEPTOR_H_

#include <chrono>
#include <string>

#include "grpcpp/grpcpp.h"
#include "grpcpp/support/server_interceptor.h"
#include "overtone/services/mapping_server/metrics/rpc_metrics.h"

namespace overtone {

// One call, from its beginning to its end. gRPC calls it for one thing at a time.
class CallInterceptor final : public grpc::experimental::Interceptor {
 public:
  CallInterceptor(MethodMetrics* metrics, grpc::experimental::ServerRpcInfo* info);
  ~CallInterceptor() override;

  void Intercept(grpc::experimental::InterceptorBatchMethods* methods) override;

 private:
  using Methods = grpc::experimental::InterceptorBatchMethods;
  using Clock = std::chrono::steady_clock;

  // Takes the peer's id if it is one, and else puts ours in its place, for the handler to read.
  void OnReceivedMetadata(Methods* methods);
  // The id goes out with the answer, and once more with an error.
  void OnStatus(Methods* methods);
  void Log(const grpc::Status& status) const;

  MethodMetrics* const metrics_;
  grpc::experimental::ServerRpcInfo* const info_;
  const Clock::time_point begin_ = Clock::now();
  std::string request_id_;
  bool ended_ = false;
};

class CallInterceptorFactory final : public grpc::experimental::ServerInterceptorFactoryInterface {
 public:
  // `metrics` outlives the server.
  explicit CallInterceptorFactory(RpcMetrics* metrics) : metrics_(metrics) {}

  grpc::experimental::Interceptor* CreateServerInterceptor(
      grpc::experimental::ServerRpcInfo* info) override {
    return new CallInterceptor(&metrics_->Of(info->method()), info);
  }

 private:
  RpcMetrics* const metrics_;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_RPC_CALL_INTERCEPTOR_H_
