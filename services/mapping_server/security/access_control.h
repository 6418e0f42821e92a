// SPDX-License-Identifier: Apache-2.0
// Every call's door: who calls, and may they. Without TLS everybody may do everything.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_SECURITY_ACCESS_CONTROL_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_SECURITY_ACCESS_CONTROL_H_

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "absl/base/thread_annotations.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "grpcpp/grpcpp.h"
#include "overtone/services/mapping_server/security/access_rules.h"
#include "overtone/services/mapping_server/security/peer_certificate.h"
#include "overtone/v1/mapping_service.pb.h"

namespace overtone {

// Thread-safe. Unauthenticated: the certificate gives no identity, or is revoked. PermissionDenied:
// the rules do not allow it.
class AccessControl {
 public:
  // Without rules: open to all.
  AccessControl() = default;
  AccessControl(AccessRules rules, bool accept_dns_names);

  // From now on; ends the streams that are no longer allowed.
  void SetRules(AccessRules rules);

  absl::StatusOr<PeerIdentity> Authenticate(const PeerCertificate& peer) const;

  // For each call a question. `Context` is grpc::CallbackServerContext, or the PeerCertificate
  // taken from it earlier.
  template <typename Context>
  absl::Status MayRead(const Context& context, const std::string& map) const {
    return Check(context, [&](const AccessRules& rules, const PeerIdentity& peer) {
      return rules.MayRead(peer, map);
    });
  }
  template <typename Context>
  absl::Status MayWrite(const Context& context, const std::string& map, const std::string& robot,
                        absl::string_view prefix) const {
    return Check(context, [&](const AccessRules& rules, const PeerIdentity& peer) {
      return rules.MayWrite(peer, map, robot, prefix);
    });
  }
  // One end of each closure must be the robot's own.
  absl::Status MayAddClosures(const grpc::CallbackServerContext& context,
                              const v1::AddLoopClosuresRequest& request) const;
  absl::Status MayAdminister(const grpc::CallbackServerContext& context,
                             const std::string& map) const {
    return Check(context, [&](const AccessRules& rules, const PeerIdentity& peer) {
      return rules.MayAdminister(peer, map);
    });
  }

  // What belongs to no map: for every operator.
  absl::Status MayOperate(const grpc::CallbackServerContext& context) const {
    return Check(context,
                 [](const AccessRules&, const PeerIdentity& peer) { return MustBeOperator(peer); });
  }

  // Whether the caller may know of a map; PermissionDenied: of none, being a robot.
  using MapFilter = std::function<bool(const std::string& map)>;
  absl::StatusOr<MapFilter> VisibleMaps(const grpc::CallbackServerContext& context) const;

  // Asks `may` now and whenever the rules change, as long as `lease` lives. Refused now: the
  // result. Refused later: `end`, on the thread that changed the rules; `end` may drop the lease.
  using Lease = std::shared_ptr<void>;
  absl::Status Hold(std::function<absl::Status()> may, std::function<void(const absl::Status&)> end,
                    Lease& lease);

 private:
  struct Held {
    std::function<absl::Status()> may;
    std::function<void(const absl::Status&)> end;
  };
  struct Rules {
    AccessRules rules;
    bool accept_dns_names = false;
  };
  using Question = std::function<absl::Status(const AccessRules&, const PeerIdentity&)>;

  std::shared_ptr<const Rules> CurrentRules() const;
  static absl::StatusOr<PeerIdentity> Authenticate(const Rules& rules, const PeerCertificate& peer);
  absl::Status Check(const PeerCertificate& peer, const Question& question) const;
  absl::Status Check(const grpc::CallbackServerContext& context, const Question& question) const;

  mutable absl::Mutex mutex_;
  std::shared_ptr<const Rules> rules_ ABSL_GUARDED_BY(mutex_);  // null: open
  std::map<uint64_t, Held> held_ ABSL_GUARDED_BY(mutex_);
  uint64_t next_held_ ABSL_GUARDED_BY(mutex_) = 0;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_SECURITY_ACCESS_CONTROL_H_
