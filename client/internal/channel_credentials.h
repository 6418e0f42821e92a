// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_CLIENT_INTERNAL_CHANNEL_CREDENTIALS_H_
#define OVERTONE_CLIENT_INTERNAL_CHANNEL_CREDENTIALS_H_

#include <memory>

#include "absl/status/status.h"
#include "grpcpp/security/credentials.h"
#include "grpcpp/support/channel_arguments.h"
#include "overtone/client/tls_files.h"

namespace overtone {

// Whether the files that `tls` names can be used as they are now; ok without TLS. The error names
// the member, "key_file: ...".
absl::Status CheckFiles(const TlsFiles& tls);

// For a channel, with what it needs in its arguments. Files that turn bad later only break new
// connections, until they are good again.
std::shared_ptr<grpc::ChannelCredentials> MakeChannelCredentials(const TlsFiles& tls,
                                                                 grpc::ChannelArguments* arguments);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_INTERNAL_CHANNEL_CREDENTIALS_H_
