// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/security/access_control.h"

#include <vector>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/security/certificate_io.h"

namespace overtone {

AccessControl::AccessControl(AccessRules rules, bool accept_dns_names)
    : rules_(std::make_shared<const Rules>(Rules{std::move(rules), accept_dns_names})) {}

void AccessControl::SetRules(AccessRules rules) {
  std::vector<Held> held;
  {
    absl::MutexLock lock(&mutex_);
    const bool accept_dns_names = rules_ != nullptr && rules_->accept_dns_names;
    rules_ = std::make_shared<const Rules>(Rules{std::move(rules), accept_dns_names});
    for (const auto& [id, stream] : held_) held.push_back(stream);
  }
  for (const Held& stream : held) {
    const absl::Status status = stream.may();
    if (!status.ok()) stream.end(status);
  }
}

std::shared_ptr<const AccessControl::Rules> AccessControl::CurrentRules() const {
  absl::MutexLock lock(&mutex_);
  return rules_;
}

absl::StatusOr<PeerIdentity> AccessControl::Authenticate(const Rules& rules,
                                                         const PeerCertificate& peer) {
  ASSIGN_OR_RETURN(PeerIdentity identity, ParsePeerIdentity(peer.names, rules.accept_dns_names));
  if (rules.rules.revoked.count(identity) > 0) {
    return absl::UnauthenticatedError(
        absl::StrCat("certificate: ", ToString(identity), " is revoked"));
  }
  if (rules.rules.revoked_fingerprints.empty()) return identity;
  const absl::StatusOr<std::string> fingerprint = CertificateFingerprint(peer.pem);
  if (fingerprint.ok() && rules.rules.revoked_fingerprints.count(*fingerprint) == 0) {
    return identity;
  }
  return absl::UnauthenticatedError(
      absl::StrCat("certificate: this one of ", ToString(identity), "'s is revoked"));
}

absl::StatusOr<PeerIdentity> AccessControl::Authenticate(const PeerCertificate& peer) const {
  const std::shared_ptr<const Rules> rules = CurrentRules();
  if (rules == nullptr) return absl::FailedPreconditionError("there are no identities without TLS");
  return Authenticate(*rules, peer);
}

absl::Status AccessControl::Check(const PeerCertificate& peer, const Question& question) const {
  const std::shared_ptr<const Rules> rules = CurrentRules();
  if (rules == nullptr) return absl::OkStatus();
  ASSIGN_OR_RETURN(const PeerIdentity identity, Authenticate(*rules, peer));
  return question(rules->rules, identity);
}

absl::Status AccessControl::Check(const grpc::CallbackServerContext& context,
                                  const Question& question) const {
  if (CurrentRules() == nullptr) return absl::OkStatus();
  return Check(PeerCertificateOf(context), question);
}

absl::Status AccessControl::MayAddClosures(const grpc::CallbackServerContext& context,
                                           const v1::AddLoopClosuresRequest& request) const {
  return Check(context, [&](const AccessRules& rules, const PeerIdentity& peer) {
    RETURN_IF_ERROR(rules.MayWrite(peer, request.map(), peer.name));
    for (int i = 0; i < request.loop_closures_size(); ++i) {
      const v1::LoopClosure& closure = request.loop_closures(i);
      if (closure.from().mission().robot() == peer.name) continue;
      if (closure.to().mission().robot() == peer.name) continue;
      return absl::PermissionDeniedError(absl::StrCat("loop_closures[", i, "]: neither end is of ",
                                                      ToString(peer), ", whose certificate it is"));
    }
    return absl::OkStatus();
  });
}

absl::StatusOr<AccessControl::MapFilter> AccessControl::VisibleMaps(
    const grpc::CallbackServerContext& context) const {
  const std::shared_ptr<const Rules> rules = CurrentRules();
  if (rules == nullptr) return MapFilter([](const std::string&) { return true; });
  ASSIGN_OR_RETURN(PeerIdentity peer, Authenticate(*rules, PeerCertificateOf(context)));
  RETURN_IF_ERROR(overtone::MustBeOperator(peer));
  return MapFilter([rules, peer = std::move(peer)](const std::string& map) {
    return rules->rules.IsGranted(peer, map);
  });
}

absl::Status AccessControl::Hold(std::function<absl::Status()> may,
                                 std::function<void(const absl::Status&)> end, Lease& lease) {
  uint64_t id = 0;
  {
    absl::MutexLock lock(&mutex_);
    id = next_held_++;
    held_.emplace(id, Held{may, std::move(end)});
  }
  // Only then asked, so that no change of the rules falls between.
  lease = Lease(nullptr, [this, id](void*) {
    absl::MutexLock lock(&mutex_);
    held_.erase(id);
  });
  return may();
}

}  // namespace overtone
