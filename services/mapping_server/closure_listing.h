// SPDX-License-Identifier: Apache-2.0
// Which loops there are, which there are not, and why: views of the newest snapshot and of the
// place search. Errors are relative to the request.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_CLOSURE_LISTING_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_CLOSURE_LISTING_H_

#include "absl/status/statusor.h"
#include "overtone/services/mapping_server/map_registry.h"
#include "overtone/v1/map_admin_service.pb.h"

namespace overtone {

// As in the newest revision.
absl::StatusOr<v1::ListLoopClosuresResponse> ListLoopClosures(
    const MapRegistry& registry, const v1::ListLoopClosuresRequest& request);

// NotFound: no such keyframe in the newest revision.
absl::StatusOr<v1::ExplainLoopClosuresResponse> ExplainLoopClosures(
    const MapRegistry& registry, const v1::ExplainLoopClosuresRequest& request);

absl::StatusOr<v1::ListRevisionsResponse> ListRevisions(const MapRegistry& registry,
                                                        const v1::ListRevisionsRequest& request);

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_CLOSURE_LISTING_H_
