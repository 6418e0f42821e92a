// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_CLIENT_MAPPING_CLIENT_OPTIONS_H_
#define OVERTONE_CLIENT_MAPPING_CLIENT_OPTIONS_H_

#include <cstdint>
#include <functional>
#include <string>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "absl/time/time.h"
#include "overtone/client/tls_files.h"
#include "overtone/core/common/ids.h"
#include "overtone/core/graph/point_cloud_codec.h"
#include "overtone/core/synchronization/synchronization_options.h"

namespace overtone {

// How much a message of the library matters.
enum class LogLevel { kInfo, kWarning, kError };

// Who this robot is, which server it talks to, and what that may cost.
struct MappingClientOptions {
  std::string server = "localhost:7077";  // host:port
  TlsFiles tls;                           // needed for a server on another host
  std::string map = "default";            // id rule of core/common/ids.h
  MissionId mission;  // robot and mission; a new mission for every run of the robot

  // What waits for the server's acknowledgement. When full, the oldest clouds are dropped; when
  // there are none any more, AddSubmap answers ResourceExhausted.
  int64_t outbox_capacity_bytes = 256 << 20;
  // Where it waits, one file for each mission; made if it does not exist. It survives the end of
  // the process: a mission then goes on where MappingClient::NextSubmap says, and what is left of
  // this robot's other missions goes up too. Empty: in memory, and lost with the process. One
  // directory for each server.
  std::string outbox_dir;
  // At least so often what waits is made to survive a loss of power, too.
  absl::Duration outbox_sync_interval = absl::Seconds(1);
  // Bound on what goes up, for radios: 0: none. Poses still go before clouds.
  int64_t max_upload_bytes_per_s = 0;
  // How clouds are encoded.
  CloudCodecOptions clouds;

  // Nodes the server may send, 0: the server's own limit. The server Kron-reduces above it.
  int32_t max_nodes = 0;
  // COMPACT and DELTA frames: a tenth of the bytes; false: PLAIN, for debugging.
  bool compact = true;
  // Ask for the graph of every mission, not only of our own.
  bool whole_map = false;

  // Compare and correct when a new revision arrives, at most this often, and so seldom that it
  // takes no more than a tenth of a core. Infinite: only when the host calls Synchronize().
  absl::Duration min_time_between_comparisons = absl::Seconds(1);

  absl::Duration initial_backoff = absl::Milliseconds(100);
  // Short enough for the first byte to go out within 5 s after the link has healed.
  absl::Duration max_backoff = absl::Seconds(4);
  // Nothing heard for so long: LinkState::kStale.
  absl::Duration stale_after = absl::Seconds(15);

  // Warn in the log when the robot's clock is certainly further than this from the server's. The
  // mission itself does not depend on it: stamps are compared with those of the same robot only.
  absl::Duration clock_offset_warning = absl::Milliseconds(500);

  // Tell the server after each comparison, and at least so often, how the link fares and what the
  // comparison found: for operators to see, nothing depends on it. It takes up to 10 kB for a
  // comparison, and never more than a twentieth of max_upload_bytes_per_s.
  bool report_status = true;
  absl::Duration report_interval = absl::Seconds(10);

  SynchronizationOptions synchronization;

  // Where the library's messages go; none by default. Called from the client's threads.
  std::function<void(LogLevel, absl::string_view)> log;

  // InvalidArgument naming the member.
  absl::Status Validate() const;
};

}  // namespace overtone

#endif  // OVERTONE_CLIENT_MAPPING_CLIENT_OPTIONS_H_
