// SPDX-License-Identifier: Apache-2.0
// A CA for one test, certificates of any kind by it, and a folder that goes with the test.
#ifndef OVERTONE_TESTS_SUPPORT_TEST_CERTIFICATES_H_
#define OVERTONE_TESTS_SUPPORT_TEST_CERTIFICATES_H_

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "gtest/gtest.h"
#include "overtone/client/cli/development_certificates.h"

namespace overtone::testing {

class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string pattern = ::testing::TempDir() + "/overtone-XXXXXX";
    path_ = mkdtemp(pattern.data());
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  // Replaces the file at once, as one should with a file that somebody watches.
  std::string Write(const std::string& name, const std::string& text) const {
    std::ofstream(path_ + "/draft") << text;
    const std::string path = path_ + "/" + name;
    std::filesystem::rename(path_ + "/draft", path);
    return path;
  }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

class TestAuthority {
 public:
  TestAuthority() : ca_(*MakeCertificateAuthority(ValidNow())) {}

  const std::string& ca_pem() const { return ca_.certificate_pem; }

  CertificateAndKey Issue(const CertificateRequest& request) const {
    return *IssueCertificate(ca_, request);
  }
  // With these URIs and DNS names, valid now.
  CertificateAndKey Peer(std::vector<std::string> uris, std::vector<std::string> dns = {}) const {
    CertificateRequest request = ValidNow();
    request.uris = std::move(uris);
    request.dns = std::move(dns);
    return Issue(request);
  }
  CertificateAndKey Robot(const std::string& id) const {
    return Peer({absl::StrCat("spiffe://test/robot/", id)});
  }
  CertificateAndKey Operator(const std::string& name) const {
    return Peer({absl::StrCat("spiffe://test/operator/", name)});
  }
  // Of localhost.
  CertificateAndKey Server() const {
    CertificateRequest request = ValidNow();
    request.use = CertificateUse::kServer;
    request.dns = {"localhost"};
    return Issue(request);
  }

  static CertificateRequest ValidNow() {
    CertificateRequest request;
    request.common_name = "test";
    request.not_before = absl::Now() - absl::Hours(1);
    request.not_after = absl::Now() + absl::Hours(24 * 30);
    return request;
  }

 private:
  CertificateAndKey ca_;
};

}  // namespace overtone::testing

#endif  // OVERTONE_TESTS_SUPPORT_TEST_CERTIFICATES_H_
