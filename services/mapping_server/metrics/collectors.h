// SPDX-License-Identifier: Apache-2.0
// Where the values of metric_descriptions.cc come from. Each reads its source when it is asked;
// what belongs to a map that is gone is not told any more.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_METRICS_COLLECTORS_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_METRICS_COLLECTORS_H_

#include <string>

#include "overtone/services/mapping_server/data_directory.h"
#include "overtone/services/mapping_server/hosted_map.h"
#include "overtone/services/mapping_server/metrics/metric_set.h"
#include "overtone/services/mapping_server/metrics/rpc_metrics.h"
#include "overtone/services/mapping_server/quota/robot_quotas.h"
#include "overtone/services/mapping_server/upload_sessions.h"

namespace overtone {

// Of Linux' /proc/self; what cannot be read is left out.
void CollectProcess(MetricSet& set);
void CollectRpcs(const RpcMetrics& rpcs, MetricSet& set);
void CollectQuotas(const RobotQuotas::Refusals& refusals, MetricSet& set);
// Free and total bytes of the disk; nothing when there is no such folder.
void CollectDisk(const std::string& data_dir, MetricSet& set);
void CollectMap(HostedMap& map, const DataDirectory& directory, MetricSet& set);
// The robots that have missions in the map.
void CollectRobots(HostedMap& map, const UploadSessions& sessions, MetricSet& set);

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_METRICS_COLLECTORS_H_
