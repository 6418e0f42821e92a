// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/rpc/report_status.h"

#include <memory>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/field_path.h"
#include "overtone/proto/conversion/id_conversion.h"
#include "overtone/proto/conversion/report_conversion.h"

namespace overtone {
namespace {

absl::Status CheckStored(const HostedMap& map, const MissionId& mission) {
  if (map.store().State(mission).next_sequence > 0) return absl::OkStatus();
  return absl::NotFoundError(
      absl::StrCat("mission: map '", map.id(), "' has no ", ToString(mission)));
}

}  // namespace

absl::StatusOr<v1::ReportStatusResponse> ReportStatus(const MapRegistry& registry,
                                                      const v1::ReportStatusRequest& request) {
  RETURN_IF_ERROR(ValidateId(request.map(), "map"));
  ASSIGN_OR_RETURN(const MissionId mission, AtField("mission", FromProto(request.mission())));
  RETURN_IF_ERROR(AtField("link", Validate(request.link())));
  RETURN_IF_ERROR(AtField("comparison", Validate(request.comparison())));
  ASSIGN_OR_RETURN(const std::shared_ptr<HostedMap> map, registry.Find(request.map()));
  RETURN_IF_ERROR(CheckStored(*map, mission));
  map->reports().Put(mission, request, absl::Now());
  return v1::ReportStatusResponse();
}

absl::StatusOr<v1::GetStatusReportResponse> GetStatusReport(
    const MapRegistry& registry, const v1::GetStatusReportRequest& request) {
  ASSIGN_OR_RETURN(const std::shared_ptr<HostedMap> map, registry.Find(request.map()));
  ASSIGN_OR_RETURN(const MissionId mission, AtField("mission", FromProto(request.mission())));
  RETURN_IF_ERROR(CheckStored(*map, mission));
  const StatusReports::Report report = map->reports().Get(mission);
  if (report == nullptr) {
    return absl::NotFoundError(
        absl::StrCat("mission: ", ToString(mission), " has not reported since the map was opened"));
  }
  v1::GetStatusReportResponse response;
  *response.mutable_report() = *report;
  return response;
}

}  // namespace overtone
