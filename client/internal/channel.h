// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_CLIENT_INTERNAL_CHANNEL_H_
#define OVERTONE_CLIENT_INTERNAL_CHANNEL_H_

#include <memory>

#include "grpcpp/channel.h"
#include "overtone/client/mapping_client_options.h"

namespace overtone {

// A connection of the client's own to options.server that is set up when first used, notices a
// half-open link within 15 s and reconnects with the backoff of `options`. Does not wait for the
// server.
std::shared_ptr<grpc::Channel> CreateChannel(const MappingClientOptions& options);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_INTERNAL_CHANNEL_H_
