// SPDX-License-Identifier: Apache-2.0
// Every request that is one message, of MappingService and MapAdminService, as far as an answer.
// The first byte says which; Run() is the list. UploadSubmaps is a stream: uploads.cc.
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/graph_conversion.h"
#include "overtone/proto/conversion/status_conversion.h"
#include "overtone/services/mapping_server/closure_listing.h"
#include "overtone/services/mapping_server/map_file.h"
#include "overtone/services/mapping_server/map_listing.h"
#include "overtone/services/mapping_server/merged_cloud.h"
#include "overtone/services/mapping_server/rpc/report_status.h"
#include "overtone/services/mapping_server/rpc/unary.h"
#include "overtone/tests/fuzz/message_input.h"
#include "overtone/tests/fuzz/request_world.h"
#include "spdlog/spdlog.h"

namespace overtone::fuzz {
namespace {

RequestWorld& World() {
  static auto* world = [] {
    spdlog::set_level(spdlog::level::off);
    return new RequestWorld();
  }();
  return *world;
}

// Every roll-back starts a new one.
uint64_t NextEpoch() {
  static uint64_t epoch = 1;
  return ++epoch;
}

absl::Status GetGraph(const v1::GetGraphRequest& request) {
  RETURN_IF_ERROR(World().registry().Find(request.map()).status());
  ASSIGN_OR_RETURN(const GraphQuery query,
                   ReadQuery(request.options(), World().options().graph.max_nodes));
  ASSIGN_OR_RETURN(const GraphEncoding encoding,
                   ReadEncoding(request.options(), v1::GRAPH_ENCODING_PLAIN));
  ASSIGN_OR_RETURN(const v1::Graph graph, World().frames().Newest(query, encoding));
  const absl::StatusOr<MapGraph> received = FromProto(graph);
  FUZZ_CHECK(received.ok(), received.status().ToString());
  return absl::OkStatus();
}

absl::Status WatchGraph(const v1::WatchGraphRequest& request) {
  RETURN_IF_ERROR(World().registry().Find(request.map()).status());
  ASSIGN_OR_RETURN(const GraphQuery query,
                   ReadQuery(request.options(), World().options().graph.max_nodes));
  ASSIGN_OR_RETURN(const GraphEncoding encoding,
                   ReadEncoding(request.options(), v1::GRAPH_ENCODING_COMPACT));
  return World()
      .frames()
      .Frame(query, encoding, {request.map_epoch(), request.after_revision()})
      .status();
}

// Runs `call` on the message, and turns its status into an answer, as the service does.
template <typename Request, typename Call>
void Answer(absl::string_view bytes, const Call& call) {
  Request request;
  if (!Parse(bytes, &request)) return;
  const absl::Status status = call(request);
  FUZZ_CHECK(!absl::IsInternal(status), status.ToString());
  (void)ToGrpcStatus(status);
}

void Run(absl::string_view input) {
  const uint8_t method = TakeSelector(input);
  RequestWorld& world = World();
  const MapRegistry& registry = world.registry();
  switch (method) {
    case 'u':
      return Answer<v1::GetUploadStateRequest>(
          input, [&](const auto& r) { return GetUploadState(registry, r).status(); });
    case 'p':
      return Answer<v1::ReportStatusRequest>(
          input, [&](const auto& r) { return ReportStatus(registry, r).status(); });
    case 'q':
      return Answer<v1::GetStatusReportRequest>(
          input, [&](const auto& r) { return GetStatusReport(registry, r).status(); });
    case 'c':
      return Answer<v1::AddLoopClosuresRequest>(
          input, [&](const auto& r) { return CheckClosures(r).status(); });
    case 'w':
      return Answer<v1::WatchGraphRequest>(input, WatchGraph);
    case 'g':
      return Answer<v1::GetGraphRequest>(input, GetGraph);
    case 'm':
      return Answer<v1::ListMapsRequest>(input, [&](const auto& r) {
        return ListMaps(
                   registry, [](const std::string&) { return true; }, r)
            .status();
      });
    case 'r':
      return Answer<v1::ListRobotsRequest>(
          input, [&](const auto& r) { return ListRobots(registry, world.sessions(), r).status(); });
    case 's':
      return Answer<v1::ListMissionsRequest>(
          input, [&](const auto& r) { return ListMissions(registry, r).status(); });
    case 'l':
      return Answer<v1::ListLoopClosuresRequest>(
          input, [&](const auto& r) { return ListLoopClosures(registry, r).status(); });
    case 'e':
      return Answer<v1::ExplainLoopClosuresRequest>(
          input, [&](const auto& r) { return ExplainLoopClosures(registry, r).status(); });
    case 'v':
      return Answer<v1::VetoLoopClosureRequest>(
          input, [&](const auto& r) { return world.decided().Veto(r.id()); });
    case 'f':
      return Answer<v1::ForceLoopClosureRequest>(
          input, [&](const auto& r) { return world.decided().Force(r.id()); });
    case 'h':
      return Answer<v1::ListRevisionsRequest>(
          input, [&](const auto& r) { return ListRevisions(registry, r).status(); });
    case 'b':
      return Answer<v1::RollBackRequest>(input, [&](const auto& r) {
        return world.decided().RollBack(r.revision(), NextEpoch()).status();
      });
    case 't':
      return Answer<v1::GetTrajectoryRequest>(input, [&](const auto& r) {
        return GetTrajectory(registry, r, world.options().limits.max_message_bytes).status();
      });
    case 'x':
      return Answer<v1::ExportMapRequest>(input, [&](const auto& r) {
        const bool clouds = r.format() == v1::EXPORT_FORMAT_PLY;
        return clouds ? ReadCloudExport(r).status() : MapFile(registry, r).status();
      });
    default:
      return;
  }
}

}  // namespace
}  // namespace overtone::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  overtone::fuzz::Run(overtone::fuzz::AsText(data, size));
  return 0;
}
