// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/submap_store/store_salvage.h"

#include <cstdio>
#include <filesystem>
#include <system_error>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {

absl::Status CheckBeforeOpening(const std::string& path) {
  std::error_code error;
  const auto size = std::filesystem::file_size(path, error);
  const auto log_size = std::filesystem::file_size(path + "-wal", error);
  if (!error && size == 0 && log_size > 0) return absl::DataLossError("the file is empty");
  return absl::OkStatus();
}

absl::Status CheckStructure(SqliteDatabase* database) {
  ASSIGN_OR_RETURN(SqliteStatement check, database->Prepare("PRAGMA quick_check(1)"));
  ASSIGN_OR_RETURN(const bool row, check.Step());
  if (row && check.Bytes(0) == "ok") return absl::OkStatus();
  return absl::DataLossError(absl::StrCat("its pages do not fit together: ", check.Bytes(0)));
}

absl::Status SalvageStore(const std::string& path, const std::string&, LossList* losses) {
  const std::string kept = absl::StrCat(
      path, ".damaged-", absl::FormatTime("%Y%m%dT%H%M%E6SZ", absl::Now(), absl::UTCTimeZone()));
  for (const char* suffix : {"", "-wal"}) {
    std::rename((path + suffix).c_str(), (kept + suffix).c_str());
  }
  std::remove((path + "-shm").c_str());
  losses->Add(absl::StrCat("the file was damaged; it is kept as ", kept));
  return absl::OkStatus();
}

}  // namespace overtone
