// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/security/certificate_io.h"

#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/x509.h>

#include <cstdint>
#include <ctime>
#include <fstream>
#include <iterator>
#include <memory>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {
namespace {

struct Free {
  void operator()(BIO* bio) const { BIO_free(bio); }
  void operator()(X509* certificate) const { X509_free(certificate); }
  void operator()(EVP_PKEY* key) const { EVP_PKEY_free(key); }
};
using Bio = std::unique_ptr<BIO, Free>;
using Certificate = std::unique_ptr<X509, Free>;
using Key = std::unique_ptr<EVP_PKEY, Free>;

// An encrypted key must fail, not ask on the terminal.
int NoPassphrase(char*, int, int, void*) { return -1; }

Bio OpenMemory(absl::string_view text) {
  return Bio(BIO_new_mem_buf(text.data(), static_cast<int>(text.size())));
}

Certificate ParseCertificate(absl::string_view pem) {
  const Bio bio = OpenMemory(pem);
  Certificate certificate(PEM_read_bio_X509(bio.get(), nullptr, NoPassphrase, nullptr));
  ERR_clear_error();  // or gRPC takes our error for one of its own
  return certificate;
}

Key ParseKey(absl::string_view pem) {
  const Bio bio = OpenMemory(pem);
  Key key(PEM_read_bio_PrivateKey(bio.get(), nullptr, NoPassphrase, nullptr));
  ERR_clear_error();
  return key;
}

absl::Time NotAfter(const X509& certificate) {
  std::tm time = {};
  if (ASN1_TIME_to_tm(X509_get0_notAfter(&certificate), &time) != 1) return absl::InfiniteFuture();
  return absl::FromTM(time, absl::UTCTimeZone());
}

absl::StatusOr<std::string> ReadFile(absl::string_view option, const std::string& path) {
  if (path.empty()) return absl::InvalidArgumentError(absl::StrCat(option, ": missing"));
  std::ifstream in(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  if (in.bad() || !in.is_open() || text.empty()) {
    return absl::NotFoundError(absl::StrCat(option, ": ", path, ": cannot be read, or is empty"));
  }
  return text;
}

absl::Status Unusable(absl::string_view option, const std::string& path, absl::string_view why) {
  return absl::InvalidArgumentError(absl::StrCat(option, ": ", path, ": ", why));
}

}  // namespace

absl::StatusOr<Certificates> ReadCertificates(const CertificateFiles& files) {
  Certificates read;
  ASSIGN_OR_RETURN(read.ca_pem, ReadFile("ca_file", files.ca_file));
  ASSIGN_OR_RETURN(read.certificate_pem, ReadFile("certificate_file", files.certificate_file));
  ASSIGN_OR_RETURN(read.key_pem, ReadFile("key_file", files.key_file));
  if (ParseCertificate(read.ca_pem) == nullptr) {
    return Unusable("ca_file", files.ca_file, "holds no certificate in PEM");
  }
  const Certificate certificate = ParseCertificate(read.certificate_pem);
  if (certificate == nullptr) {
    return Unusable("certificate_file", files.certificate_file, "holds no certificate in PEM");
  }
  const Key key = ParseKey(read.key_pem);
  if (key == nullptr) {
    return Unusable("key_file", files.key_file,
                    "holds no private key in PEM that is readable without a passphrase");
  }
  const bool match = X509_check_private_key(certificate.get(), key.get()) == 1;
  ERR_clear_error();
  if (!match) {
    return Unusable("key_file", files.key_file,
                    absl::StrCat("is not the key of ", files.certificate_file));
  }
  read.not_after = NotAfter(*certificate);
  return read;
}

absl::StatusOr<std::string> CertificateFingerprint(absl::string_view pem) {
  const Certificate certificate = ParseCertificate(pem);
  if (certificate == nullptr) return absl::InvalidArgumentError("not a certificate in PEM");
  unsigned char digest[EVP_MAX_MD_SIZE];
  unsigned int size = 0;
  if (X509_digest(certificate.get(), EVP_sha256(), digest, &size) != 1) {
    return absl::InternalError("SHA-256 failed");
  }
  return absl::BytesToHexString(absl::string_view(reinterpret_cast<const char*>(digest), size));
}

}  // namespace overtone
