// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/internal/outbox_recovery.h"

#include <filesystem>
#include <system_error>
#include <utility>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {
namespace {

absl::StatusOr<OpenedOutbox> OpenIntact(const std::string& path) {
  OpenedOutbox opened;
  ASSIGN_OR_RETURN(opened.file, OutboxFile::Open(path));
  ASSIGN_OR_RETURN(opened.content, opened.file->Load());
  return opened;
}

// The log goes along: it holds what was written last.
absl::StatusOr<std::string> SetAside(const std::string& path) {
  std::error_code error;
  int number = 1;
  while (std::filesystem::exists(absl::StrCat(path, ".damaged-", number), error)) ++number;
  std::string target = absl::StrCat(path, ".damaged-", number);
  std::filesystem::rename(path, target, error);
  if (error) {
    return absl::ResourceExhaustedError(
        absl::StrCat("cannot rename ", path, ": ", error.message()));
  }
  std::filesystem::rename(path + "-wal", target + "-wal", error);  // there may be none
  return target;
}

}  // namespace

absl::StatusOr<OpenedOutbox> OpenOutbox(const std::string& path) {
  absl::StatusOr<OpenedOutbox> opened = OpenIntact(path);
  return absl::IsDataLoss(opened.status()) ? RecoverOutbox(path) : std::move(opened);
}

absl::StatusOr<OpenedOutbox> RecoverOutbox(const std::string& path) {
  OpenedOutbox opened;
  ASSIGN_OR_RETURN(opened.set_aside, SetAside(path));
  ASSIGN_OR_RETURN(opened.file, OutboxFile::Open(path));
  const auto damaged = OutboxFile::Open(opened.set_aside);
  if (damaged.ok()) opened.content = (*damaged)->Salvage(*opened.file);
  return opened;
}

}  // namespace overtone
