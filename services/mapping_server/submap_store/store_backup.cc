// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <system_error>

#include "absl/strings/str_cat.h"
#include "openssl/rand.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/services/mapping_server/submap_store/store_verify.h"
#include "overtone/services/mapping_server/submap_store/sync_file.h"

namespace overtone {
namespace {

// The copy goes its own way from here: what the original acknowledges later is not missing in it.
absl::Status GiveOwnIdentity(StoreTables& copy) {
  absl::StatusOr<StateRow> state = copy.GetState();
  if (absl::IsNotFound(state.status())) return absl::OkStatus();
  RETURN_IF_ERROR(state.status());
  RAND_bytes(reinterpret_cast<unsigned char*>(state->store_id.data()),
             static_cast<int>(state->store_id.size()));
  return copy.PutState(*state);
}

absl::Status Copy(StoreTables& tables, const std::string& to) {
  ASSIGN_OR_RETURN(SqliteStatement vacuum, tables.database().Prepare("VACUUM INTO ?"));
  RETURN_IF_ERROR(vacuum.BindText(1, to).Run());
  {
    ASSIGN_OR_RETURN(const auto copy, StoreTables::Open(to, SqliteDatabase::Mode::kReadWrite, ""));
    RETURN_IF_ERROR(GiveOwnIdentity(*copy));
  }
  return SyncFile(to);
}

}  // namespace

absl::Status BackUpStore(StoreTables& tables, const std::string& to) {
  std::error_code error;
  if (std::filesystem::exists(to, error)) {
    return absl::AlreadyExistsError(absl::StrCat(to, ": is there already"));
  }
  const std::string partial = to + ".partial";
  std::filesystem::remove(partial, error);
  absl::Status status = Copy(tables, partial);
  // link fails where a file has come into being meanwhile; rename would replace it.
  if (status.ok() && link(partial.c_str(), to.c_str()) != 0) {
    status = errno == EEXIST
                 ? absl::AlreadyExistsError(absl::StrCat(to, ": is there already"))
                 : absl::ResourceExhaustedError(absl::StrCat(to, ": ", std::strerror(errno)));
  }
  std::filesystem::remove(partial, error);
  RETURN_IF_ERROR(status);
  return SyncFolderOf(to);
}

}  // namespace overtone
