// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/dashboard/proto_json.h"

#include <string>

#include "absl/strings/ascii.h"
#include "absl/strings/string_view.h"
#include "absl/strings/strip.h"
#include "google/protobuf/duration.pb.h"
#include "overtone/services/dashboard/view_json.h"

namespace overtone {
namespace {

using nlohmann::json;

std::string WithoutPrefix(absl::string_view name, absl::string_view prefix) {
  if (name.empty()) return "unspecified";
  return absl::AsciiStrToLower(absl::StripPrefix(name, prefix));
}

std::string KindName(v1::ConstraintKind kind) {
  return WithoutPrefix(v1::ConstraintKind_Name(kind), "CONSTRAINT_KIND_");
}

json Seconds(bool is_set, const google::protobuf::Duration& duration) {
  if (!is_set) return nullptr;
  return static_cast<double>(duration.seconds()) + 1e-9 * duration.nanos();
}

json ToJson(const v1::NodeId& node) {
  return {{"robot", node.mission().robot()},
          {"mission", node.mission().mission()},
          {"index", node.index()}};
}

json ToJson(const v1::RegistrationFigures& figures) {
  return {{"overlap", figures.overlap()},
          {"overlap_threshold", figures.overlap_threshold()},
          {"residual_m", figures.residual_m()},
          {"residual_limit_m", figures.residual_limit_m()},
          {"open_directions", figures.open_directions()},
          {"converged", figures.converged()}};
}

}  // namespace

std::string VerdictName(v1::LoopClosureVerdict verdict) {
  return WithoutPrefix(v1::LoopClosureVerdict_Name(verdict), "LOOP_CLOSURE_VERDICT_");
}

json Milliseconds(bool is_set, const google::protobuf::Timestamp& time) {
  if (!is_set) return nullptr;
  return 1000 * time.seconds() + time.nanos() / 1'000'000;
}

json ToJson(const v1::Pose& pose) {
  const v1::Vector3& p = pose.position();
  const v1::Quaternion& q = pose.orientation();
  return {{"p", {p.x(), p.y(), p.z()}}, {"q", {q.x(), q.y(), q.z(), q.w()}}};
}

json ToJson(const v1::LinkReport& link) {
  return {{"submaps_waiting", link.submaps_waiting()},
          {"blobs_waiting", link.blobs_waiting()},
          {"bytes_waiting", link.bytes_waiting()},
          {"bytes_sent", link.bytes_sent()},
          {"bytes_received", link.bytes_received()},
          {"report_bytes_sent", link.report_bytes_sent()},
          {"reconnects", link.reconnects()},
          {"clouds_dropped", link.clouds_dropped()},
          {"clock_offset_s", Seconds(link.has_clock_offset(), link.clock_offset())},
          {"clock_offset_uncertainty_s",
           Seconds(link.has_clock_offset_uncertainty(), link.clock_offset_uncertainty())},
          {"outbox_on_disk", link.outbox_on_disk()},
          {"client_version", link.client_version()}};
}

json ToJson(const v1::ComparisonReport& comparison) {
  json constraints = json::object();
  for (const v1::ConstraintCount& count : comparison.constraints()) {
    constraints[KindName(count.kind())] = count.added();
  }
  json largest = json::array();
  for (const v1::ConstraintEnds& ends : comparison.largest()) {
    largest.push_back({{"kind", KindName(ends.kind())},
                       {"from", ends.from()},
                       {"to", ends.to()},
                       {"score", ends.score()}});
  }
  const auto metres = [](bool is_set, double value) { return is_set ? json(value) : json(); };
  return {{"revision", comparison.revision()},
          {"time_ms", Milliseconds(comparison.has_time(), comparison.time())},
          {"nodes", comparison.nodes()},
          {"duration_s", comparison.duration_s()},
          {"constraints", constraints},
          {"largest", largest},
          {"updated", comparison.updated()},
          {"retracted", comparison.retracted()},
          {"applied", comparison.applied()},
          {"rmse_before_m", metres(comparison.has_rmse_before_m(), comparison.rmse_before_m())},
          {"predicted_rmse_m",
           metres(comparison.has_predicted_rmse_m(), comparison.predicted_rmse_m())},
          {"held_back", comparison.held_back()}};
}

json ToJson(const v1::LoopClosureStatus& closure) {
  json message = {{"id", closure.id()},
                  {"from", ToJson(closure.loop_closure().from())},
                  {"to", ToJson(closure.loop_closure().to())},
                  {"verdict", VerdictName(closure.verdict())},
                  {"weight", closure.weight()},
                  {"chi_square", closure.chi_square()},
                  {"proposer", WithoutPrefix(v1::LoopClosureProposer_Name(closure.proposer()),
                                             "LOOP_CLOSURE_PROPOSER_")},
                  {"score", closure.score()},
                  {"score_threshold", closure.score_threshold()},
                  {"reason", closure.reason()},
                  {"measured", closure.measured()},
                  {"since_revision", closure.since_revision()}};
  if (closure.has_registration()) message["registration"] = ToJson(closure.registration());
  return message;
}

json ToJson(const google::protobuf::RepeatedPtrField<v1::VerdictCount>& counts) {
  json verdicts = json::object();
  for (const v1::VerdictCount& count : counts) {
    verdicts[VerdictName(count.verdict())] = count.count();
  }
  return verdicts;
}

json ToJson(const v1::Revision& revision) {
  json stages = json::array();
  for (const v1::StageTime& stage : revision.stages()) {
    stages.push_back({{"stage", stage.stage()}, {"seconds", stage.seconds()}});
  }
  return {
      {"revision", revision.revision()},
      {"epoch", revision.map_epoch()},
      {"published_ms", Milliseconds(revision.has_published(), revision.published())},
      {"missions", revision.missions()},
      {"anchored_missions", revision.anchored_missions()},
      {"components", revision.components()},
      {"keyframes", revision.keyframes()},
      {"verdicts", ToJson(revision.verdicts())},
      {"accepted",
       std::vector<std::string>(revision.accepted().begin(), revision.accepted().end())},
      {"dropped", std::vector<std::string>(revision.dropped().begin(), revision.dropped().end())},
      {"cost_before", revision.cost_before()},
      {"cost_after", revision.cost_after()},
      {"mean_move_m", revision.mean_move_m()},
      {"largest_move_m", revision.largest_move_m()},
      {"optimisation_s", revision.optimisation_s()},
      {"stages", stages}};
}

}  // namespace overtone
