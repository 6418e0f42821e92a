// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/internal/channel.h"

#include "absl/time/time.h"
#include "grpcpp/create_channel.h"
#include "grpcpp/support/channel_arguments.h"
#include "overtone/client/internal/channel_credentials.h"

namespace overtone {
namespace {

constexpr absl::Duration kKeepaliveTime = absl::Seconds(10);  // a ping after so much silence ...
// ... and the link is dead without an answer. On a link of 64 kbit/s the ping waits for the 64 KiB
// of HTTP/2's window that are before it: eight seconds.
constexpr absl::Duration kKeepaliveTimeout = absl::Seconds(10);
constexpr absl::Duration kConnectTimeout =
    absl::Seconds(3);  // a lost SYN must not cost gRPC's 20 s
// A graph of 300,000 nodes in PLAIN, a million in COMPACT. gRPC's default of 4 MB holds 20,000 in
// PLAIN.
constexpr int kMaxReceiveBytes = 64 << 20;

int Milliseconds(absl::Duration duration) {
  return static_cast<int>(absl::ToInt64Milliseconds(duration));
}

}  // namespace

std::shared_ptr<grpc::Channel> CreateChannel(const MappingClientOptions& options) {
  grpc::ChannelArguments arguments;
  arguments.SetInt(GRPC_ARG_KEEPALIVE_TIME_MS, Milliseconds(kKeepaliveTime));
  arguments.SetInt(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, Milliseconds(kKeepaliveTimeout));
  arguments.SetInt(GRPC_ARG_HTTP2_MAX_PINGS_WITHOUT_DATA,
                   0);  // no limit: silence is when they are needed
  arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, Milliseconds(options.initial_backoff));
  arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, Milliseconds(options.max_backoff));
  arguments.SetInt(GRPC_ARG_MIN_RECONNECT_BACKOFF_MS, Milliseconds(kConnectTimeout));
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL,
                   1);  // two clients in one process fail separately
  arguments.SetMaxReceiveMessageSize(kMaxReceiveBytes);
  const auto credentials = MakeChannelCredentials(options.tls, &arguments);
  return grpc::CreateCustomChannel(options.server, credentials, arguments);
}

}  // namespace overtone
