// SPDX-License-Identifier: Apache-2.0
// What goes on in a server's maps, look by look: a picture that a terminal shows anew each time, or
// lines of what has changed.
#ifndef OVERTONE_CLIENT_CLI_WATCH_H_
#define OVERTONE_CLIENT_CLI_WATCH_H_

#include <map>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "overtone/client/cli/admin_client.h"

namespace overtone {

struct WatchedMap {
  v1::MapSummary summary;
  std::vector<v1::Robot> robots;
};

// `map`: only this one; empty: all. A map that is not there yet is no error.
absl::StatusOr<std::vector<WatchedMap>> LookAt(AdminClient& client, const std::string& map);

// Everything at once: the map, its closures by verdict, a table of its robots. At most `rows`
// lines, the last of which says how many more there are; 0: all.
std::string Picture(const std::vector<WatchedMap>& maps, int rows);

// Remembers what it has said. Not thread-safe.
class ChangeLog {
 public:
  // `json`: each line an object {"time", "map", "summary": MapSummary} or {"time", "map", "robot":
  // Robot} or {"time", "error"}; else "13:02:11 town: revision 12, ...".
  explicit ChangeLog(bool json) : json_(json) {}

  // A line for each map and robot that is not what it was, each with its line break. Bytes alone
  // are no change.
  std::string Changes(const std::vector<WatchedMap>& maps, absl::Time now);
  // Once for each loss of the server.
  std::string Lost(const absl::Status& status, absl::Time now);

 private:
  std::string Line(const std::string& key, const std::string& words, const std::string& object,
                   absl::Time now);

  const bool json_;
  bool lost_ = false;
  std::map<std::string, std::string> said_;  // by map or map/robot
};

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_WATCH_H_
