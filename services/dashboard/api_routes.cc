// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/dashboard/api_routes.h"

#include <memory>
#include <string>
#include <utility>

#include "absl/status/statusor.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "nlohmann/json.hpp"
#include "overtone/services/dashboard/view_json.h"

namespace overtone {
namespace {

using httplib::Request;
using httplib::Response;
using nlohmann::json;

const char kJson[] = "application/json";
const char kBytes[] = "application/octet-stream";
constexpr double kDefaultVoxelM = 0.2;
constexpr size_t kMaxClosureIdBytes = 1024;

int HttpStatus(absl::StatusCode code) {
  switch (code) {
    case absl::StatusCode::kInvalidArgument:
      return 400;
    case absl::StatusCode::kPermissionDenied:
    case absl::StatusCode::kUnauthenticated:
      return 403;
    case absl::StatusCode::kNotFound:
      return 404;
    case absl::StatusCode::kFailedPrecondition:
      return 409;
    case absl::StatusCode::kResourceExhausted:
      return 429;
    case absl::StatusCode::kUnimplemented:
      return 501;
    case absl::StatusCode::kUnavailable:
      return 503;
    default:
      return 502;
  }
}

// What the server said may hold any bytes.
std::string Dump(const json& value) {
  return value.dump(-1, ' ', false, json::error_handler_t::replace);
}

void Fail(const absl::Status& status, Response& response) {
  response.status = HttpStatus(status.code());
  response.set_content(Dump({{"code", absl::StatusCodeToString(status.code())},
                             {"error", std::string(status.message())}}),
                       kJson);
}

void Answer(const json& value, Response& response) { response.set_content(Dump(value), kJson); }

absl::StatusOr<uint64_t> Unsigned(const Request& request, const char* name) {
  uint64_t number = 0;
  if (!request.has_param(name)) return number;
  if (absl::SimpleAtoi(request.get_param_value(name), &number)) return number;
  return absl::InvalidArgumentError(absl::StrCat(name, ": not a number"));
}

absl::StatusOr<double> VoxelM(const Request& request) {
  if (!request.has_param("voxel_m")) return kDefaultVoxelM;
  double voxel_m = 0;
  if (absl::SimpleAtod(request.get_param_value("voxel_m"), &voxel_m) && voxel_m >= 0.01 &&
      voxel_m <= 100) {
    return voxel_m;
  }
  return absl::InvalidArgumentError("voxel_m: not within 0.01 and 100");
}

absl::StatusOr<std::string> ClosureId(const std::string& body) {
  const json parsed = json::parse(body, nullptr, false);
  const auto id = parsed.is_object() ? parsed.find("id") : parsed.end();
  if (!parsed.is_object() || id == parsed.end() || !id->is_string()) {
    return absl::InvalidArgumentError("id: missing");
  }
  std::string text = id->get<std::string>();
  if (!text.empty() && text.size() <= kMaxClosureIdBytes) return text;
  return absl::InvalidArgumentError("id: empty or too long");
}

json Config(const DashboardOptions& options) {
  return {{"server", options.connection.server},
          {"map", options.map},
          {"read_only", options.read_only},
          {"interval_s", absl::ToDoubleSeconds(options.mirror.interval)},
          {"version", OVERTONE_VERSION}};
}

void SendTracks(const ApiContext& context, TrackKind kind, const Request& request,
                Response& response) {
  const absl::StatusOr<uint64_t> since = Unsigned(request, "since");
  if (!since.ok()) return Fail(since.status(), response);
  response.set_content(TracksSince(*context.mirror->view(), kind, *since), kBytes);
}

void SendRevision(const ApiContext& context, const Request& request, Response& response) {
  uint64_t epoch = 0;
  uint64_t revision = 0;
  std::shared_ptr<const std::string> frame;
  if (absl::SimpleAtoi(request.matches[1].str(), &epoch) &&
      absl::SimpleAtoi(request.matches[2].str(), &revision)) {
    frame = context.history->Frame(epoch, revision);
  }
  if (frame == nullptr) return Fail(absl::NotFoundError("revision: not kept"), response);
  response.set_content(*frame, kBytes);
}

void SendCloud(const ApiContext& context, const Request& request, Response& response) {
  const absl::StatusOr<double> voxel_m = VoxelM(request);
  if (!voxel_m.ok()) return Fail(voxel_m.status(), response);
  const auto file = context.clouds->Get(*context.mirror->view(), *voxel_m);
  if (!file.ok()) return Fail(file.status(), response);
  response.set_content(**file, kBytes);
}

void Veto(const ApiContext& context, const Request& request, Response& response) {
  const auto refuse = [&response](const char* why) {
    Fail(absl::PermissionDeniedError(why), response);
  };
  if (context.options->read_only) return refuse("this dashboard is read-only");
  if (!context.guard->IsOurPage(request.get_header_value("Host"),
                                request.get_header_value("Origin"),
                                request.get_header_value("Sec-Fetch-Site"),
                                request.get_header_value("X-Overtone-Dashboard"))) {
    return refuse("not from the dashboard's own page");
  }
  const absl::StatusOr<std::string> id = ClosureId(request.body);
  if (!id.ok()) return Fail(id.status(), response);
  const absl::Status status = context.api->Veto(*id);
  if (!status.ok()) return Fail(status, response);
  context.mirror->AskNow();
  response.status = 204;
}

}  // namespace

void AddApiRoutes(const ApiContext& context, httplib::Server& server) {
  const auto get = [&server, context](const char* path, auto answer) {
    server.Get(path, [context, answer](const Request& request, Response& response) {
      response.set_header("Cache-Control", "no-store");
      answer(context, request, response);
    });
  };
  const auto get_json = [&get](const char* path, auto make) {
    get(path, [make](const ApiContext& c, const Request&, Response& response) {
      Answer(make(c), response);
    });
  };
  get_json("/api/config", [](const ApiContext& c) { return Config(*c.options); });
  get_json("/api/state", [](const ApiContext& c) {
    json state = StateJson(*c.mirror->view());
    state["instance"] = c.started_ms;
    return state;
  });
  get_json("/api/closures", [](const ApiContext& c) { return ClosuresJson(*c.mirror->view()); });
  get_json("/api/revisions",
           [](const ApiContext& c) { return RevisionsJson(*c.mirror->view(), c.history->List()); });
  for (const auto& [path, kind] : {std::make_pair("/api/positions", TrackKind::kPositions),
                                   std::make_pair("/api/odometry", TrackKind::kOdometry),
                                   std::make_pair("/api/discrepancy", TrackKind::kDiscrepancy)}) {
    get(path, [kind = kind](const ApiContext& c, const Request& request, Response& response) {
      SendTracks(c, kind, request, response);
    });
  }
  get(R"(/api/revisions/(\d+)/(\d+))", SendRevision);
  get("/api/cloud", SendCloud);
  get("/api/events",
      [](const ApiContext& c, const Request&, Response& response) { c.events->Serve(response); });
  server.Post("/api/closures/veto", [context](const Request& request, Response& response) {
    Veto(context, request, response);
  });
}

}  // namespace overtone
