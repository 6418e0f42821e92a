// SPDX-License-Identifier: Apache-2.0
// ReportStatus, and GetStatusReport that tells operators what came with it.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_RPC_REPORT_STATUS_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_RPC_REPORT_STATUS_H_

#include "absl/status/statusor.h"
#include "overtone/services/mapping_server/map_registry.h"
#include "overtone/v1/map_admin_service.pb.h"
#include "overtone/v1/mapping_service.pb.h"

namespace overtone {

// InvalidArgument naming the field (report_conversion.h). NotFound: no such map, or nothing of the
// mission is stored in it yet.
absl::StatusOr<v1::ReportStatusResponse> ReportStatus(const MapRegistry& registry,
                                                      const v1::ReportStatusRequest& request);

// NotFound: no such map, no such mission, or its robot has not reported.
absl::StatusOr<v1::GetStatusReportResponse> GetStatusReport(
    const MapRegistry& registry, const v1::GetStatusReportRequest& request);

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_RPC_REPORT_STATUS_H_
