// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/certificate_folder.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "overtone/client/cli/development_certificates.h"
#include "overtone/core/common/ids.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {
namespace {

// Clocks of robots may be a little behind ours.
constexpr absl::Duration kClockSkew = absl::Hours(1);

bool IsIp(const std::string& name) {
  unsigned char address[sizeof(in6_addr)];
  return inet_pton(AF_INET, name.c_str(), address) == 1 ||
         inet_pton(AF_INET6, name.c_str(), address) == 1;
}

bool IsDnsName(const std::string& name) {
  return !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
    return absl::ascii_isalnum(c) || c == '-' || c == '.' || c == '*';
  });
}

// Replaces the file at once or not at all.
absl::Status WriteFile(const std::string& path, const std::string& text, mode_t mode) {
  const std::string draft = path + ".new";
  unlink(draft.c_str());
  const int file = open(draft.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
  if (file < 0) return absl::UnavailableError(absl::StrCat("cannot write ", path));
  const ssize_t size = static_cast<ssize_t>(text.size());
  const bool written = write(file, text.data(), text.size()) == size && fsync(file) == 0;
  close(file);
  if (written && rename(draft.c_str(), path.c_str()) == 0) return absl::OkStatus();
  unlink(draft.c_str());
  return absl::UnavailableError(absl::StrCat("cannot write ", path));
}

std::string ReadFile(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

std::string AccessFile(const CertificateFolderOptions& options) {
  return absl::StrCat("# Who may use which map; the server reads it again when it changes.\n",
                      "# \"*\" stands for every map, robot or operator.\n", "maps:\n  ",
                      options.map, ":\n    robots: [", absl::StrJoin(options.robots, ", "),
                      "]\n    operators: [", absl::StrJoin(options.operators, ", "),
                      "]\n# Identities (robot/<id>, operator/<name>) and certificates "
                      "(\"sha256:<fingerprint>\").\n",
                      "revoked: []\n");
}

class Folder {
 public:
  Folder(const CertificateFolderOptions& options, absl::Time now) : options_(options), now_(now) {}

  absl::StatusOr<CertificateFolderChanges> Fill() {
    std::error_code error;
    std::filesystem::create_directories(options_.folder, error);
    if (error) return absl::UnavailableError(absl::StrCat("cannot create ", options_.folder));
    ASSIGN_OR_RETURN(const CertificateAndKey ca, Authority());
    RETURN_IF_ERROR(Issue(ca, "server", ServerRequest()));
    for (const std::string& robot : options_.robots) {
      RETURN_IF_ERROR(Issue(ca, "robot-" + robot, Request("robot", robot)));
    }
    for (const std::string& name : options_.operators) {
      RETURN_IF_ERROR(Issue(ca, "operator-" + name, Request("operator", name)));
    }
    RETURN_IF_ERROR(WriteAccessFile());
    return std::move(changes_);
  }

 private:
  std::string Path(const std::string& name) const {
    return absl::StrCat(options_.folder, "/", name);
  }

  CertificateRequest Request(const std::string& role, const std::string& name) const {
    CertificateRequest request;
    request.common_name = name;
    request.uris = {absl::StrCat("spiffe://", options_.trust_domain, "/", role, "/", name)};
    request.not_before = now_ - kClockSkew;
    request.not_after = now_ + absl::Hours(24) * options_.days;
    return request;
  }

  CertificateRequest ServerRequest() const {
    CertificateRequest request = Request("server", "mapping-server");
    request.use = CertificateUse::kServer;
    for (const std::string& name : options_.server_names) {
      (IsIp(name) ? request.ips : request.dns).push_back(name);
    }
    return request;
  }

  // Whether both halves are there and are to be kept.
  absl::StatusOr<bool> Keep(const std::string& name) {
    const bool certificate = std::filesystem::exists(Path(name + ".crt"));
    const bool key = std::filesystem::exists(Path(name + ".key"));
    if (options_.force || (!certificate && !key)) return false;
    if (certificate != key) {
      return absl::FailedPreconditionError(
          absl::StrCat(Path(name + (key ? ".key" : ".crt")), " is there without its ",
                       key ? ".crt" : ".key", "; remove it, or make all anew with --force"));
    }
    changes_.kept.push_back(name + ".crt");
    return true;
  }

  absl::Status Write(const std::string& name, const CertificateAndKey& pair) {
    RETURN_IF_ERROR(WriteFile(Path(name + ".key"), pair.key_pem, 0600));
    RETURN_IF_ERROR(WriteFile(Path(name + ".crt"), pair.certificate_pem, 0644));
    changes_.written.push_back(name + ".crt");
    return absl::OkStatus();
  }

  absl::StatusOr<CertificateAndKey> Authority() {
    ASSIGN_OR_RETURN(const bool keep, Keep("ca"));
    if (keep) return CertificateAndKey{ReadFile(Path("ca.crt")), ReadFile(Path("ca.key"))};
    CertificateRequest request = Request("", "Overtone development CA");
    ASSIGN_OR_RETURN(CertificateAndKey ca, MakeCertificateAuthority(request));
    RETURN_IF_ERROR(Write("ca", ca));
    return ca;
  }

  absl::Status Issue(const CertificateAndKey& ca, const std::string& name,
                     const CertificateRequest& request) {
    ASSIGN_OR_RETURN(const bool keep, Keep(name));
    if (keep) return absl::OkStatus();
    ASSIGN_OR_RETURN(const CertificateAndKey pair, IssueCertificate(ca, request));
    return Write(name, pair);
  }

  absl::Status WriteAccessFile() {
    if (!options_.force && std::filesystem::exists(Path("access.yaml"))) {
      changes_.kept.push_back("access.yaml");
      return absl::OkStatus();
    }
    RETURN_IF_ERROR(WriteFile(Path("access.yaml"), AccessFile(options_), 0644));
    changes_.written.push_back("access.yaml");
    return absl::OkStatus();
  }

  const CertificateFolderOptions& options_;
  const absl::Time now_;
  CertificateFolderChanges changes_;
};

}  // namespace

absl::Status CertificateFolderOptions::Validate() const {
  for (const std::string& name : server_names) {
    if (IsIp(name) || IsDnsName(name)) continue;
    return absl::InvalidArgumentError(
        absl::StrCat("--server-name: '", name, "' is neither a DNS name nor an IP address"));
  }
  for (const std::string& robot : robots) RETURN_IF_ERROR(ValidateId(robot, "--robot"));
  for (const std::string& name : operators) RETURN_IF_ERROR(ValidateId(name, "--operator"));
  RETURN_IF_ERROR(ValidateId(map, "--map"));
  if (!IsDnsName(trust_domain)) {
    return absl::InvalidArgumentError(
        absl::StrCat("--trust-domain: '", trust_domain, "' is not a DNS name"));
  }
  if (days >= 1 && days <= 36500) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat("--days: ", days, " is not in [1, 36500]"));
}

absl::StatusOr<CertificateFolderChanges> FillCertificateFolder(
    const CertificateFolderOptions& options, absl::Time now) {
  RETURN_IF_ERROR(options.Validate());
  return Folder(options, now).Fill();
}

}  // namespace overtone
