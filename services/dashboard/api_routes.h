// SPDX-License-Identifier: Apache-2.0
// What the page asks for, under /api.
//
//   GET  config                     what this service was started with
//   GET  state                      link, map, missions, robots, versions of the rest
//   GET  positions|odometry|discrepancy?since=VERSION     track_frame.h
//   GET  closures, revisions
//   GET  revisions/EPOCH/REVISION   positions of a revision that was seen: track_frame.h
//   GET  cloud?voxel_m=METRES       PLY
//   GET  events                     event_stream.h
//   POST closures/veto {"id": ...}  204
// Errors are {"code": "NOT_FOUND", "error": "..."} with a fitting status.
#ifndef OVERTONE_SERVICES_DASHBOARD_API_ROUTES_H_
#define OVERTONE_SERVICES_DASHBOARD_API_ROUTES_H_

#include <cstdint>

#include "overtone/services/dashboard/cloud_cache.h"
#include "overtone/services/dashboard/dashboard_options.h"
#include "overtone/services/dashboard/event_stream.h"
#include "overtone/services/dashboard/http_guard.h"
#include "overtone/services/dashboard/http_library.h"
#include "overtone/services/dashboard/map_api.h"
#include "overtone/services/dashboard/map_mirror.h"
#include "overtone/services/dashboard/revision_archive.h"

namespace overtone {

// All must outlive the server; all are thread-safe.
struct ApiContext {
  const DashboardOptions* options;
  const HttpGuard* guard;
  MapApi* api;
  RevisionArchive* history;
  MapMirror* mirror;
  CloudCache* clouds;
  EventStream* events;
  int64_t started_ms;  // tells a page that this is another process, whose versions count anew
};

void AddApiRoutes(const ApiContext& context, httplib::Server& server);

}  // namespace overtone

#endif  // OVERTONE_SERVICES_DASHBOARD_API_ROUTES_H_
