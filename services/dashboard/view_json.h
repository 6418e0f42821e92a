// SPDX-License-Identifier: Apache-2.0
// A view as JSON for the page, and its tracks as frames. Times are milliseconds since 1970, server
// clock; lengths metres; angles none.
#ifndef OVERTONE_SERVICES_DASHBOARD_VIEW_JSON_H_
#define OVERTONE_SERVICES_DASHBOARD_VIEW_JSON_H_

#include <cstdint>
#include <string>
#include <vector>

#include "nlohmann/json.hpp"
#include "overtone/services/dashboard/map_view.h"
#include "overtone/services/dashboard/revision_archive.h"

namespace overtone {

// "accepted", "demoted_by_optimiser", ...: the enum's own names; "unspecified" for what a newer
// server may say.
std::string VerdictName(v1::LoopClosureVerdict verdict);

// Link, map, missions, robots: all that is small or changes often. The rest has a version here, and
// is fetched when that changed.
nlohmann::json StateJson(const MapView& view);
nlohmann::json ClosuresJson(const MapView& view);
// The server's account of each revision, newest first, and which of them `seen` can show.
nlohmann::json RevisionsJson(const MapView& view, const std::vector<SeenRevision>& seen);

enum class TrackKind { kPositions, kOdometry, kDiscrepancy };

// The tracks of one kind that changed after `since`.
std::string TracksSince(const MapView& view, TrackKind kind, uint64_t since);

}  // namespace overtone

#endif  // OVERTONE_SERVICES_DASHBOARD_VIEW_JSON_H_
