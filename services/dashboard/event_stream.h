// SPDX-License-Identifier: Apache-2.0
// Server-Sent Events: "there is a newer view", nothing else, so that a slow page skips some and
// nothing piles up for it. The page then fetches what changed.
#ifndef OVERTONE_SERVICES_DASHBOARD_EVENT_STREAM_H_
#define OVERTONE_SERVICES_DASHBOARD_EVENT_STREAM_H_

#include <atomic>

#include "overtone/services/dashboard/http_library.h"
#include "overtone/services/dashboard/map_mirror.h"

namespace overtone {

class EventStream {
 public:
  // Each page that listens holds a thread of the HTTP server.
  EventStream(const MapMirror* mirror, int max_listeners)
      : mirror_(mirror), max_listeners_(max_listeners) {}

  // 503 beyond max_listeners: the page then asks every few seconds. Ends when the mirror stops.
  void Serve(httplib::Response& response);

 private:
  const MapMirror* const mirror_;
  const int max_listeners_;
  std::atomic<int> listeners_{0};
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_DASHBOARD_EVENT_STREAM_H_
