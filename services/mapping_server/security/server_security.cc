// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/security/server_security.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/field_path.h"
#include "overtone/services/mapping_server/security/access_file.h"
#include "spdlog/spdlog.h"

namespace overtone {
namespace {

constexpr absl::Duration kSoon = absl::Hours(14 * 24);

void WarnOfExpiry(const Certificates& certificates) {
  const absl::Duration left = certificates.not_after - absl::Now();
  if (left > kSoon) return;
  spdlog::warn("tls.certificate_file: {} {}",
               left > absl::ZeroDuration() ? "expires" : "peers refuse it, it has expired",
               absl::FormatTime(certificates.not_after, absl::UTCTimeZone()));
}

absl::StatusOr<AccessRules> Read(const std::string& access_file) {
  absl::StatusOr<AccessRules> rules = ReadAccessFile(access_file);
  if (rules.ok()) return rules;
  return absl::Status(rules.status().code(),
                      absl::StrCat("access_file: ", rules.status().message()));
}

}  // namespace

absl::StatusOr<std::unique_ptr<ServerSecurity>> ServerSecurity::Create(
    const SecurityOptions& options) {
  if (!options.tls()) return std::unique_ptr<ServerSecurity>(new ServerSecurity(options));
  ASSIGN_OR_RETURN(Certificates certificates, AtField("tls", ReadCertificates(options.files)));
  WarnOfExpiry(certificates);
  ASSIGN_OR_RETURN(AccessRules rules, Read(options.access_file));
  return std::unique_ptr<ServerSecurity>(
      new ServerSecurity(options, std::move(certificates), std::move(rules)));
}

ServerSecurity::ServerSecurity(const SecurityOptions& options, Certificates certificates,
                               AccessRules rules)
    : options_(options),
      certificates_(std::make_unique<ServingCertificates>(std::move(certificates))),
      access_(rules, options.accept_dns_names),
      rules_(std::move(rules)),
      reload_(
          std::make_unique<PeriodicTask>(absl::Seconds(options.reload_s), [this] { Reload(); })) {}

std::shared_ptr<grpc::ServerCredentials> ServerSecurity::Credentials() {
  if (certificates_ == nullptr) return grpc::InsecureServerCredentials();
  return MakeTlsServerCredentials(certificates_.get(), &access_);
}

void ServerSecurity::Reload() {
  if (certificates_ == nullptr) return;
  absl::MutexLock lock(&mutex_);
  Log("certificates", ReloadCertificates(), certificates_error_);
  Log("access rules", ReloadRules(), rules_error_);
}

absl::StatusOr<bool> ServerSecurity::ReloadCertificates() {
  ASSIGN_OR_RETURN(Certificates certificates, AtField("tls", ReadCertificates(options_.files)));
  if (!certificates_->Set(certificates)) return false;
  WarnOfExpiry(certificates);
  return true;
}

absl::StatusOr<bool> ServerSecurity::ReloadRules() {
  ASSIGN_OR_RETURN(AccessRules rules, Read(options_.access_file));
  if (rules == rules_) return false;
  rules_ = rules;
  access_.SetRules(std::move(rules));
  return true;
}

void ServerSecurity::Log(const char* what, const absl::StatusOr<bool>& changed,
                         std::string& last_error) {
  const std::string error(changed.status().message());
  if (changed.ok() && *changed) spdlog::info("new {} are in force", what);
  if (!changed.ok() && error != last_error) {
    spdlog::error("{}; the {} from before stay in force", error, what);
  }
  last_error = error;
}

}  // namespace overtone
