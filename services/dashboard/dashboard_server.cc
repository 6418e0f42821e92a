// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/dashboard/dashboard_server.h"

#include <set>
#include <string>
#include <thread>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/services/dashboard/api_routes.h"
#include "overtone/services/dashboard/http_library.h"

namespace overtone {
namespace {

constexpr int kMaxListeners = 24;  // pages open at once
constexpr int kThreads = kMaxListeners + 16;
constexpr size_t kMaxRequestBytes = 16 << 10;
constexpr int kIdleS = 2;  // a connection without a request holds a thread so long
constexpr int kIoTimeoutS = 10;

std::set<std::string> Names(const DashboardOptions& options, const std::string& listen_host) {
  std::set<std::string> names = {HostName(listen_host)};
  for (const std::string& name : options.allowed_hosts) names.insert(HostName(name));
  return names;
}

httplib::Headers SecurityHeaders() {
  return {{"Content-Security-Policy", kContentSecurityPolicy},
          {"X-Content-Type-Options", "nosniff"},
          {"Referrer-Policy", "no-referrer"},
          {"Cross-Origin-Resource-Policy", "same-origin"},
          {"Cross-Origin-Opener-Policy", "same-origin"}};
}

}  // namespace

struct DashboardServer::Parts {
  Parts(const DashboardOptions& given, const ListenAddress& address,
        const std::shared_ptr<grpc::Channel>& channel)
      : options(given),
        listen(address),
        guard(Names(options, listen.host)),
        api(channel, options.map, absl::Seconds(options.timeout_s)),
        history(static_cast<size_t>(options.history_mib) << 20, options.history_nodes),
        clouds(&api, options.cloud_points),
        mirror(&api, &history, options.mirror),
        events(&mirror, kMaxListeners) {}

  void ConfigureHttp();
  void AddPage();
  absl::Status Listen();

  const DashboardOptions options;
  const ListenAddress listen;
  const HttpGuard guard;
  MapApi api;
  RevisionArchive history;
  CloudCache clouds;
  MapMirror mirror;
  EventStream events;
  httplib::Server http;
  int port = 0;
  std::thread thread;
};

void DashboardServer::Parts::ConfigureHttp() {
  http.new_task_queue = [] { return new httplib::ThreadPool(kThreads); };
  http.set_payload_max_length(kMaxRequestBytes);
  http.set_keep_alive_timeout(kIdleS);
  http.set_read_timeout(kIoTimeoutS);
  http.set_write_timeout(kIoTimeoutS);
  http.set_tcp_nodelay(true);
  // The library's own options would let two processes listen on one port.
  http.set_socket_options([](socket_t socket) {
    const int yes = 1;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
  });
  http.set_default_headers(SecurityHeaders());
  http.set_pre_routing_handler(
      [this](const httplib::Request& request, httplib::Response& response) {
        if (guard.IsOurHost(request.get_header_value("Host"))) {
          return httplib::Server::HandlerResponse::Unhandled;
        }
        response.status = 421;  // misdirected request
        response.set_content("unknown host name; see --allowed-host\n", "text/plain");
        return httplib::Server::HandlerResponse::Handled;
      });
}

void DashboardServer::Parts::AddPage() {
  // Says that this process serves, not that the mapping server does.
  http.Get("/healthz", [](const httplib::Request&, httplib::Response& response) {
    response.set_content("ok\n", "text/plain");
  });
  const std::string& root = options.web_root;
  // Names of assets hold a digest of their content; that of the page does not.
  http.set_mount_point("/assets", root + "/assets",
                       {{"Cache-Control", "public, max-age=31536000, immutable"}});
  if (!root.empty() && http.set_mount_point("/", root, {{"Cache-Control", "no-cache"}})) return;
  http.Get("/", [](const httplib::Request&, httplib::Response& response) {
    response.status = 503;
    response.set_content(
        "The dashboard's page is not here: it is built with npm, and --web-root says where it is.\n"
        "The API below /api/ works.\n",
        "text/plain");
  });
}

absl::Status DashboardServer::Parts::Listen() {
  const bool bound = listen.port == 0 ? (port = http.bind_to_any_port(listen.host)) > 0
                                      : http.bind_to_port(listen.host, port = listen.port);
  if (!bound) {
    return absl::UnavailableError(absl::StrCat("--listen: cannot listen on ", options.listen));
  }
  thread = std::thread([this] { http.listen_after_bind(); });
  return absl::OkStatus();
}

absl::StatusOr<std::unique_ptr<DashboardServer>> DashboardServer::Start(
    const DashboardOptions& options) {
  RETURN_IF_ERROR(options.Validate());
  ASSIGN_OR_RETURN(const ListenAddress address, ParseListenAddress(options.listen));
  ASSIGN_OR_RETURN(const auto channel, MakeServerChannel(options.connection));
  auto parts = std::make_unique<Parts>(options, address, channel);
  parts->ConfigureHttp();
  Parts* const p = parts.get();
  AddApiRoutes({&p->options, &p->guard, &p->api, &p->history, &p->mirror, &p->clouds, &p->events,
                absl::ToUnixMillis(absl::Now())},
               p->http);
  parts->AddPage();
  RETURN_IF_ERROR(parts->Listen());
  return std::unique_ptr<DashboardServer>(new DashboardServer(std::move(parts)));
}

DashboardServer::DashboardServer(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}

DashboardServer::~DashboardServer() { Shutdown(); }

std::string DashboardServer::url() const {
  const std::string& host = parts_->listen.host;
  const bool is_ipv6 = host.find(':') != std::string::npos;
  return absl::StrCat("http://", is_ipv6 ? absl::StrCat("[", host, "]") : host, ":", parts_->port);
}

void DashboardServer::Shutdown() {
  parts_->mirror.Stop();
  if (!parts_->thread.joinable()) return;
  // Before it runs, stop() would be forgotten.
  while (!parts_->http.is_running()) std::this_thread::yield();
  parts_->http.stop();
  parts_->thread.join();
}

}  // namespace overtone
