// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/development_certificates.h"

#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/rand.h>
#include <openssl/x509v3.h>

#include <algorithm>
#include <memory>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {
namespace {

struct Free {
  void operator()(BIO* bio) const { BIO_free(bio); }
  void operator()(X509* certificate) const { X509_free(certificate); }
  void operator()(EVP_PKEY* key) const { EVP_PKEY_free(key); }
  void operator()(X509_EXTENSION* extension) const { X509_EXTENSION_free(extension); }
};
template <typename T>
using Owned = std::unique_ptr<T, Free>;

absl::Status Failed(absl::string_view what) {
  char reason[256] = "";
  ERR_error_string_n(ERR_get_error(), reason, sizeof(reason));
  ERR_clear_error();
  return absl::InternalError(absl::StrCat(what, ": ", reason));
}

std::string Contents(BIO* bio) {
  char* data = nullptr;
  const long size = BIO_get_mem_data(bio, &data);
  return std::string(data, size);
}

absl::StatusOr<CertificateAndKey> ToPem(X509* certificate, EVP_PKEY* key) {
  const Owned<BIO> certificate_bio(BIO_new(BIO_s_mem()));
  const Owned<BIO> key_bio(BIO_new(BIO_s_mem()));
  if (PEM_write_bio_X509(certificate_bio.get(), certificate) != 1 ||
      PEM_write_bio_PrivateKey(key_bio.get(), key, nullptr, nullptr, 0, nullptr, nullptr) != 1) {
    return Failed("PEM");
  }
  return CertificateAndKey{Contents(certificate_bio.get()), Contents(key_bio.get())};
}

absl::Status AddExtension(X509* certificate, X509* issuer, int nid, const std::string& value) {
  X509V3_CTX context;
  X509V3_set_ctx(&context, issuer, certificate, nullptr, nullptr, 0);
  const Owned<X509_EXTENSION> extension(X509V3_EXT_conf_nid(nullptr, &context, nid, value.c_str()));
  if (extension == nullptr || X509_add_ext(certificate, extension.get(), -1) != 1) {
    ERR_clear_error();
    return absl::InvalidArgumentError(absl::StrCat(OBJ_nid2ln(nid), ": cannot be '", value, "'"));
  }
  return absl::OkStatus();
}

// As in OpenSSL's configuration files: "URI:spiffe://...,DNS:localhost,IP:::1".
std::string AlternativeNames(const CertificateRequest& request) {
  std::vector<std::string> names;
  for (const std::string& uri : request.uris) names.push_back("URI:" + uri);
  for (const std::string& dns : request.dns) names.push_back("DNS:" + dns);
  for (const std::string& ip : request.ips) names.push_back("IP:" + ip);
  return absl::StrJoin(names, ",");
}

// 127 random bits: no two certificates of a CA may share one.
bool SetSerial(X509* certificate) {
  unsigned char bytes[16];
  if (RAND_bytes(bytes, sizeof(bytes)) != 1) return false;
  bytes[0] &= 0x7f;
  BIGNUM* number = BN_bin2bn(bytes, sizeof(bytes), nullptr);
  const bool set = BN_to_ASN1_INTEGER(number, X509_get_serialNumber(certificate)) != nullptr;
  BN_free(number);
  return set;
}

bool SetSubject(X509* certificate, const std::string& common_name) {
  return X509_NAME_add_entry_by_txt(X509_get_subject_name(certificate), "CN", MBSTRING_UTF8,
                                    reinterpret_cast<const unsigned char*>(common_name.c_str()), -1,
                                    -1, 0) == 1;
}

absl::StatusOr<Owned<X509>> NewCertificate(const CertificateRequest& request, EVP_PKEY* key) {
  Owned<X509> certificate(X509_new());
  const std::time_t not_before = absl::ToTimeT(request.not_before);
  const std::time_t not_after = absl::ToTimeT(request.not_after);
  if (certificate == nullptr || X509_set_version(certificate.get(), X509_VERSION_3) != 1 ||
      !SetSerial(certificate.get()) || !SetSubject(certificate.get(), request.common_name) ||
      ASN1_TIME_set(X509_getm_notBefore(certificate.get()), not_before) == nullptr ||
      ASN1_TIME_set(X509_getm_notAfter(certificate.get()), not_after) == nullptr ||
      X509_set_pubkey(certificate.get(), key) != 1) {
    return Failed("certificate");
  }
  return certificate;
}

absl::Status Sign(X509* certificate, X509* issuer, EVP_PKEY* issuer_key) {
  RETURN_IF_ERROR(AddExtension(certificate, issuer, NID_subject_key_identifier, "hash"));
  RETURN_IF_ERROR(AddExtension(certificate, issuer, NID_authority_key_identifier, "keyid"));
  if (X509_set_issuer_name(certificate, X509_get_subject_name(issuer)) != 1 ||
      X509_sign(certificate, issuer_key, EVP_sha256()) == 0) {
    return Failed("signature");
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<CertificateAndKey> MakeCertificateAuthority(const CertificateRequest& request) {
  const Owned<EVP_PKEY> key(EVP_EC_gen("P-256"));
  if (key == nullptr) return Failed("key");
  ASSIGN_OR_RETURN(const Owned<X509> certificate, NewCertificate(request, key.get()));
  X509* const ca = certificate.get();
  RETURN_IF_ERROR(AddExtension(ca, ca, NID_basic_constraints, "critical,CA:TRUE,pathlen:0"));
  RETURN_IF_ERROR(AddExtension(ca, ca, NID_key_usage, "critical,keyCertSign,cRLSign"));
  RETURN_IF_ERROR(Sign(ca, ca, key.get()));
  return ToPem(ca, key.get());
}

absl::StatusOr<CertificateAndKey> IssueCertificate(const CertificateAndKey& authority,
                                                   const CertificateRequest& request) {
  const Owned<BIO> ca_bio(BIO_new_mem_buf(authority.certificate_pem.c_str(), -1));
  const Owned<BIO> ca_key_bio(BIO_new_mem_buf(authority.key_pem.c_str(), -1));
  const Owned<X509> ca(PEM_read_bio_X509(ca_bio.get(), nullptr, nullptr, nullptr));
  const Owned<EVP_PKEY> ca_key(
      PEM_read_bio_PrivateKey(ca_key_bio.get(), nullptr, nullptr, nullptr));
  if (ca == nullptr || ca_key == nullptr || X509_check_private_key(ca.get(), ca_key.get()) != 1) {
    ERR_clear_error();
    return absl::InvalidArgumentError("the CA's files are not a certificate and its key in PEM");
  }
  const std::string names = AlternativeNames(request);
  const size_t num_names = request.uris.size() + request.dns.size() + request.ips.size();
  if (std::count(names.begin(), names.end(), ',') + 1 > std::max<size_t>(num_names, 1)) {
    return absl::InvalidArgumentError(absl::StrCat("a name with a comma: ", names));
  }
  const Owned<EVP_PKEY> key(EVP_EC_gen("P-256"));
  if (key == nullptr) return Failed("key");
  ASSIGN_OR_RETURN(const Owned<X509> certificate, NewCertificate(request, key.get()));
  X509* const leaf = certificate.get();
  RETURN_IF_ERROR(AddExtension(leaf, ca.get(), NID_basic_constraints, "critical,CA:FALSE"));
  RETURN_IF_ERROR(AddExtension(leaf, ca.get(), NID_key_usage, "critical,digitalSignature"));
  RETURN_IF_ERROR(
      AddExtension(leaf, ca.get(), NID_ext_key_usage,
                   request.use == CertificateUse::kServer ? "serverAuth" : "clientAuth"));
  if (!names.empty()) {
    RETURN_IF_ERROR(AddExtension(leaf, ca.get(), NID_subject_alt_name, names));
  }
  RETURN_IF_ERROR(Sign(leaf, ca.get(), ca_key.get()));
  return ToPem(leaf, key.get());
}

}  // namespace overtone
