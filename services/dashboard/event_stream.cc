// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/dashboard/event_stream.h"

#include <memory>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/time/time.h"

namespace overtone {
namespace {

// A comment after so much silence keeps proxies from closing the connection.
constexpr absl::Duration kSilence = absl::Seconds(10);

}  // namespace

void EventStream::Serve(httplib::Response& response) {
  if (listeners_.fetch_add(1) >= max_listeners_) {
    --listeners_;
    response.status = 503;
    response.set_content("too many pages are open", "text/plain");
    return;
  }
  auto sent = std::make_shared<uint64_t>(0);
  response.set_header("Cache-Control", "no-store");
  response.set_header("X-Accel-Buffering", "no");
  response.set_chunked_content_provider(
      "text/event-stream",
      [this, sent](size_t, httplib::DataSink& sink) {
        const auto view = mirror_->WaitForNewer(*sent, kSilence);
        if (mirror_->stopped()) {
          sink.done();
          return true;
        }
        const bool newer = view->version > *sent;
        *sent = view->version;
        const std::string event =
            newer ? absl::StrCat("data: ", view->version, "\n\n") : std::string(":\n\n");
        return sink.write(event.data(), event.size());
      },
      [this](bool) { --listeners_; });
}

}  // namespace overtone
