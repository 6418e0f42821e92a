// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_CLIENT_INTERNAL_OUTBOX_RECOVERY_H_
#define OVERTONE_CLIENT_INTERNAL_OUTBOX_RECOVERY_H_

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "overtone/client/internal/outbox_file.h"
#include "overtone/client/internal/outbox_item.h"

namespace overtone {

struct OpenedOutbox {
  std::unique_ptr<OutboxFile> file;
  OutboxContent content;
  std::string set_aside;  // where the damaged file is now; empty: it is not damaged
};

// The outbox's file, whatever became of it. A damaged one is renamed to "<path>.damaged-<n>", and
// what can be read of it goes on in a new one. Unavailable: somebody else has it open. Other errors
// are those of the disk.
absl::StatusOr<OpenedOutbox> OpenOutbox(const std::string& path);

// For a file that showed its damage later. Nobody may have it open.
absl::StatusOr<OpenedOutbox> RecoverOutbox(const std::string& path);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_INTERNAL_OUTBOX_RECOVERY_H_
