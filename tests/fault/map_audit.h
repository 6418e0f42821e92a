// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_TESTS_FAULT_MAP_AUDIT_H_
#define OVERTONE_TESTS_FAULT_MAP_AUDIT_H_

#include <cstdint>
#include <map>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "overtone/core/common/ids.h"
#include "overtone/v1/mapping_service.grpc.pb.h"

namespace overtone {

// Submaps (BusySubmap) that each mission has handed over.
using HandedOver = std::map<MissionId, int64_t>;

// What a server holds against what it should hold; all 0 when nothing is amiss.
struct MapAudit {
  int64_t submaps_lost = 0;
  int64_t submaps_doubled = 0;  // more than handed over
  int64_t keyframes_lost = 0;
  int64_t keyframes_doubled = 0;
  int64_t wrong_poses = 0;  // another stamp or pose than sent
  int64_t clouds_lost = 0;
  int64_t closures_lost = 0;
  int64_t closures_doubled = 0;

  void Add(const MapAudit& other);
  int64_t Sum() const {
    return submaps_lost + submaps_doubled + keyframes_lost + keyframes_doubled + wrong_poses +
           clouds_lost + closures_lost + closures_doubled;
  }
};
std::string ToString(const MapAudit& audit);

// Waits until the newest revision holds so many keyframes. DeadlineExceeded.
absl::Status AwaitMapped(const std::string& address, const std::string& map, int64_t keyframes,
                         absl::Duration timeout);

// As the server's API tells it.
absl::StatusOr<MapAudit> AuditMap(const std::string& address, const std::string& map,
                                  const HandedOver& handed_over);

// As the store's file tells it, whose server has ended: rows of one mission and sequence beyond the
// first. DataLoss: SQLite finds the file damaged.
absl::StatusOr<int64_t> SubmapsStoredTwice(const std::string& data_dir, const std::string& map);

absl::StatusOr<v1::GetUploadStateResponse> UploadStateOf(const std::string& address,
                                                         const std::string& map,
                                                         const MissionId& mission);

}  // namespace overtone

#endif  // OVERTONE_TESTS_FAULT_MAP_AUDIT_H_
