// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_SECURITY_STREAM_ACCESS_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_SECURITY_STREAM_ACCESS_H_

#include <memory>
#include <string>

#include "absl/status/status.h"
#include "overtone/services/mapping_server/security/access_control.h"

namespace overtone {

// One stream's right to go on: asked once its map is known, and again whenever the rules change. A
// stream that lost it is ended with `Stream::End(status)`. Goes with its stream; `control` outlives
// both. Not thread-safe.
class StreamAccess {
 public:
  StreamAccess(AccessControl* control, const grpc::CallbackServerContext& context)
      : control_(control), peer_(PeerCertificateOf(context)) {}

  template <typename Stream>
  absl::Status MayRead(const std::string& map, std::weak_ptr<Stream> stream) {
    return Hold([control = control_, peer = peer_, map] { return control->MayRead(peer, map); },
                std::move(stream));
  }
  template <typename Stream>
  absl::Status MayWrite(const std::string& map, const std::string& robot, const char* prefix,
                        std::weak_ptr<Stream> stream) {
    return Hold([control = control_, peer = peer_, map, robot,
                 prefix] { return control->MayWrite(peer, map, robot, prefix); },
                std::move(stream));
  }

 private:
  template <typename Stream>
  absl::Status Hold(std::function<absl::Status()> may, std::weak_ptr<Stream> stream) {
    return control_->Hold(
        std::move(may),
        [stream = std::move(stream)](const absl::Status& status) {
          if (const std::shared_ptr<Stream> open = stream.lock()) open->End(status);
        },
        lease_);
  }

  AccessControl* control_;
  PeerCertificate peer_;
  AccessControl::Lease lease_;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_SECURITY_STREAM_ACCESS_H_
