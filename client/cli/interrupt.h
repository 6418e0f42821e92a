// SPDX-License-Identifier: Apache-2.0
// Ctrl-C and SIGTERM as a status, so that whoever holds children unwinds and reaps them.
#ifndef OVERTONE_CLIENT_CLI_INTERRUPT_H_
#define OVERTONE_CLIENT_CLI_INTERRUPT_H_

#include "absl/status/status.h"

namespace overtone {

// From now on SIGINT and SIGTERM are noted instead of ending the process.
void CatchInterrupts();

// Cancelled after one of them came.
absl::Status CheckInterrupted();

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_INTERRUPT_H_
