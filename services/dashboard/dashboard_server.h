// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_SERVICES_DASHBOARD_DASHBOARD_SERVER_H_
#define OVERTONE_SERVICES_DASHBOARD_DASHBOARD_SERVER_H_

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "overtone/services/dashboard/dashboard_options.h"

namespace overtone {

// The whole service in one object; the binary and the tests both start it this way. A client of the
// public API and nothing more: it may run anywhere, stop and start at any time.
class DashboardServer {
 public:
  // Serves when this returns, whether the mapping server is there or not. InvalidArgument naming
  // the flag; NotFound: certificates that cannot be read; Unavailable: the address cannot be
  // listened on.
  static absl::StatusOr<std::unique_ptr<DashboardServer>> Start(const DashboardOptions& options);
  ~DashboardServer();

  // http://host:port, with the port that was taken.
  std::string url() const;

  // Ends event streams and connections. Calling it again does nothing.
  void Shutdown();

 private:
  struct Parts;
  explicit DashboardServer(std::unique_ptr<Parts> parts);

  const std::unique_ptr<Parts> parts_;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_DASHBOARD_DASHBOARD_SERVER_H_
