// SPDX-License-Identifier: Apache-2.0
// fuzz_make_corpus FOLDER writes small well-formed inputs for every target to FOLDER/<target>/, all
// of them made by the project's own writers. What a fuzzer found lies beside them as found_*.
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "overtone/client/cli/robot_recording_file.h"
#include "overtone/core/geometry/trajectory_io.h"
#include "overtone/core/graph/g2o_io.h"
#include "overtone/core/graph/point_cloud_codec.h"
#include "overtone/core/graph/point_cloud_io.h"
#include "overtone/proto/conversion/graph_conversion.h"
#include "overtone/proto/conversion/id_conversion.h"
#include "overtone/proto/conversion/sha256.h"
#include "overtone/proto/conversion/submap_conversion.h"
#include "overtone/services/mapping_server/options_file.h"
#include "overtone/tests/fuzz/memory_file.h"
#include "overtone/tests/fuzz/message_input.h"
#include "overtone/tests/fuzz/request_world.h"
#include "overtone/v1/map_admin_service.pb.h"
#include "overtone/v1/mapping_service.pb.h"

namespace overtone::fuzz {
namespace {

class Corpus {
 public:
  explicit Corpus(std::filesystem::path folder) : folder_(std::move(folder)) {}

  void Add(const std::string& target, const std::string& name, const std::string& bytes) const {
    std::filesystem::create_directories(folder_ / target);
    std::ofstream(folder_ / target / name, std::ios::binary) << bytes;
  }

 private:
  const std::filesystem::path folder_;
};

std::string Slurp(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

PointCloud SmallCloud(bool intensities) {
  PointCloud cloud;
  for (int i = 0; i < 6; ++i) {
    cloud.points.emplace_back(0.5f * i, -0.25f * i, 0.125f * (i % 3));
    if (intensities) cloud.intensities.push_back(static_cast<uint8_t>(40 * i));
  }
  return cloud;
}

Trajectory SmallTrajectory() {
  Trajectory trajectory;
  for (const Keyframe& keyframe : testing::MakeSubmap(0, 0, 3).keyframes) {
    trajectory.push_back({keyframe.stamp, keyframe.mission_from_body});
  }
  return trajectory;
}

std::string TrajectoryText(TrajectoryFormat format) {
  std::ostringstream out;
  WriteTrajectory(out, format, SmallTrajectory());
  return out.str();
}

void AddTrajectories(const Corpus& corpus) {
  corpus.Add("trajectory_files", "tum", "t" + TrajectoryText(TrajectoryFormat::kTum));
  corpus.Add("trajectory_files", "euroc", "e" + TrajectoryText(TrajectoryFormat::kEuroc));
  corpus.Add("trajectory_files", "kitti", "k" + TrajectoryText(TrajectoryFormat::kKitti));
}

std::string G2oText(bool planar) {
  G2oFile file;
  file.planar = planar;
  for (const StampedPose& pose : SmallTrajectory()) {
    file.vertex_ids.push_back(static_cast<int64_t>(file.vertex_ids.size()));
    file.graph.poses.push_back(pose.pose);
  }
  for (const auto& [from, to] : {std::pair{0, 1}, {1, 2}, {0, 2}}) {
    file.graph.edges.push_back({from, to, file.graph.poses[from].Inverse() * file.graph.poses[to],
                                100 * Matrix6d::Identity(), EdgeKind::kOdometry});
  }
  std::ostringstream out;
  WriteG2o(out, file);
  return out.str();
}

void AddGraphFiles(const Corpus& corpus) {
  corpus.Add("g2o_files", "planar", G2oText(/*planar=*/true));
  corpus.Add("g2o_files", "spatial", G2oText(/*planar=*/false));
}

void AddClouds(const Corpus& corpus) {
  for (const bool intensities : {false, true}) {
    const std::string suffix = intensities ? "_intensities" : "";
    const MemoryFile pcd("");
    FUZZ_CHECK(WritePcd(pcd.path(), SmallCloud(intensities)).ok(), "no cloud");
    corpus.Add("point_cloud_files", "pcd" + suffix, Slurp(pcd.path()));
    corpus.Add("cloud_codec", "cloud" + suffix,
               *EncodePointCloud(SmallCloud(intensities), CloudCodecOptions()));
  }
  corpus.Add("cloud_codec", "empty", *EncodePointCloud(PointCloud(), CloudCodecOptions()));
  corpus.Add("point_cloud_files", "pcd_ascii",
             "VERSION 0.7\nFIELDS x y z rgb intensity\nSIZE 4 4 8 4 1\nTYPE F F F U U\n"
             "COUNT 1 1 1 2 1\nWIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA ascii\n"
             "1 2 3 0 0 200\nnan 2 3 0 0 7\n");
  corpus.Add("point_cloud_files", "ply_ascii",
             "ply\nformat ascii 1.0\ncomment none\nelement vertex 2\nproperty float x\n"
             "property double y\nproperty float z\nproperty float intensity\nelement face 0\n"
             "end_header\n1 2 3 0.5\n4 5 6 1\n");
  corpus.Add("point_cloud_files", "ply_binary",
             "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float x\n"
             "property float y\nproperty float z\nend_header\n" +
                 std::string(12, '\x40'));
}

void AddRecordings(const Corpus& corpus) {
  const std::string kitti = TrajectoryText(TrajectoryFormat::kKitti);
  const std::string laser =
      "FLASER 3 1.0 2.5 9.0 0 0 0.1 0 0 0.1 1.5 host 1.5\n"
      "FLASER 3 1.1 2.4 9.0 0.5 0 0.2 0.5 0 0.2 2.5 host 2.5\n";
  corpus.Add("recordings", "carmen",
             "c" + laser + "%%\n" + laser + "%%\n1.5 2.5 0.5 0 0 0 0 0.1\n");
  corpus.Add("recordings", "mrclam",
             "m1.0 0.5 0.1\n2.0 0.5 0.0\n3.0 0 0\n%%\n1.5 63 2.0 0.5\n2.5 14 1.0 -0.5\n"
             "%%\n1 5\n2 14\n6 63\n%%\n1.0 0 0 0\n2.0 0.5 0 0.1\n");
  corpus.Add("recordings", "tuc",
             "todom2 1.0 0.5 0 0.1 0.01 0.01 0.001\nodom2 2.0 0.5 0 0 0.01 0.01 0.001\n"
             "odom2 3.0 0.5 0 0 0.01 0.01 0.001\nloop 1.0 3.0 0.75\n"
             "%%\npoint2 1.0 0 0 1 0 0 1\npoint2 2.0 0.5 0 1 0 0 1\n");
  corpus.Add("recordings", "pcd",
             "p" + kitti + "%%\n1.0\n1.1\n1.2\n%%\n" + kitti + "%%\n1 1 0 0\n2 0 0 0\n");
  corpus.Add("recordings", "g2o", "g" + G2oText(/*planar=*/true));
  corpus.Add(
      "recordings", "closures",
      "lfrom_robot,from_stamp_s,to_robot,to_stamp_s,x,y,z,qx,qy,qz,qw,sigma_t,sigma_r,proposer\n"
      "anna,1.0,bert,9.1,0.5,0,0,0,0,0,1,0.1,0.01,robot\n"
      "anna,3,anna,15,0.5,0,0,0,0,0,1,0.1,0.01,scan_context\n");
  corpus.Add("recordings", "alignment", "a" + kitti.substr(0, kitti.find('\n') + 1));
  RobotRecording recording;
  recording.id = {"anna", "run"};
  recording.keyframes = testing::MakeSubmap(0, 0, 2).keyframes;
  recording.closures = {testing::MakeClosure({recording.id, 0}, {recording.id, 1})};
  recording.candidates = {{{recording.id, 0}, {{"bert", "run"}, 3}, 0.5}};
  recording.observations.landmark_sightings = {{1, "tag", {1, 2, 3}, Eigen::Matrix3d::Identity()}};
  const MemoryFile json("");
  FUZZ_CHECK(WriteRobotRecording(json.path(), recording).ok(), "no recording");
  corpus.Add("recordings", "robot", "r" + Slurp(json.path()));
}

// Every key, a section each.
void AddOptions(const Corpus& corpus) {
  std::map<std::string, std::string> sections;
  for (const auto& [name, value] : OptionValues(ServerOptions())) {
    const size_t dot = name.find('.');
    const std::string text = value.empty() ? "\"\"" : value;
    if (dot == std::string::npos) {
      sections[""] += name + ": " + text + "\n";
    } else {
      sections[name.substr(0, dot)] += "  " + name.substr(dot + 1) + ": " + text + "\n";
    }
  }
  for (const auto& [section, keys] : sections) {
    corpus.Add("options_file", section.empty() ? "top" : section,
               section.empty() ? keys : section + ":\n" + keys);
  }
}

v1::GraphRequestOptions GraphOptions() {
  v1::GraphRequestOptions options;
  options.set_max_nodes(12);
  options.set_encoding(v1::GRAPH_ENCODING_COMPACT);
  options.set_include_edges(true);
  options.set_robot("anna");
  return options;
}

// The fields that requests have in common, where a request has them.
template <typename Request>
Request About(const std::string& map) {
  Request request;
  const auto* descriptor = Request::descriptor();
  const auto* reflection = request.GetReflection();
  if (const auto* field = descriptor->FindFieldByName("map")) {
    reflection->SetString(&request, field, map);
  }
  if (const auto* field = descriptor->FindFieldByName("page_size")) {
    reflection->SetInt32(&request, field, 1);
  }
  if (const auto* field = descriptor->FindFieldByName("page_token")) {
    reflection->SetString(&request, field, "after:anna");
  }
  if (const auto* field = descriptor->FindFieldByName("mission")) {
    reflection->MutableMessage(&request, field)->CopyFrom(ToProto(WorldMissions()[0]));
  }
  return request;
}

v1::ReportStatusRequest FullReport() {
  auto request = About<v1::ReportStatusRequest>("m");
  v1::LinkReport& link = *request.mutable_link();
  link.set_submaps_waiting(2);
  link.set_bytes_waiting(4096);
  link.mutable_clock_offset()->set_nanos(-20'000'000);
  link.mutable_clock_offset_uncertainty()->set_nanos(3'000'000);
  link.set_client_version("0.1.0");
  v1::ComparisonReport& comparison = *request.mutable_comparison();
  comparison.set_revision(3);
  comparison.mutable_time()->set_seconds(1'700'000'000);
  comparison.set_nodes(6);
  for (int i = 0; i < 3; ++i) {
    comparison.add_index(2 * i);
    comparison.add_small(0.5f);
    comparison.add_mid(0.25f * i);
    comparison.add_large(1.0f * i);
  }
  comparison.add_constraints()->set_kind(v1::CONSTRAINT_KIND_LARGE);
  comparison.mutable_constraints(0)->set_added(1);
  comparison.add_largest()->set_to(4);
  comparison.set_held_back("it would not help");
  return request;
}

void AddRequests(const Corpus& corpus) {
  const auto add = [&corpus](const std::string& name, char method, const auto& request) {
    corpus.Add("requests", name, method + request.SerializeAsString());
  };
  add("get_upload_state", 'u', About<v1::GetUploadStateRequest>("m"));
  add("report_status", 'p', FullReport());
  add("get_status_report", 'q', About<v1::GetStatusReportRequest>("m"));
  auto closures = About<v1::AddLoopClosuresRequest>("m");
  *closures.add_loop_closures() = ToProto(WorldClosures()[0]);
  add("add_loop_closures", 'c', closures);
  auto watch = About<v1::WatchGraphRequest>("m");
  *watch.mutable_options() = GraphOptions();
  watch.set_map_epoch(1);
  watch.set_after_revision(1);
  add("watch_graph", 'w', watch);
  auto graph = About<v1::GetGraphRequest>("m");
  *graph.mutable_options() = GraphOptions();
  add("get_graph", 'g', graph);
  add("list_maps", 'm', About<v1::ListMapsRequest>("m"));
  add("list_robots", 'r', About<v1::ListRobotsRequest>("m"));
  add("list_missions", 's', About<v1::ListMissionsRequest>("m"));
  auto list = About<v1::ListLoopClosuresRequest>("m");
  list.set_verdict(v1::LOOP_CLOSURE_VERDICT_ACCEPTED);
  list.set_proposer(v1::LOOP_CLOSURE_PROPOSER_ROBOT);
  add("list_loop_closures", 'l', list);
  auto explain = About<v1::ExplainLoopClosuresRequest>("m");
  *explain.mutable_node() = ToProto(NodeId{WorldMissions()[0], 3});
  explain.set_radius_m(2.5);
  add("explain_loop_closures", 'e', explain);
  auto veto = About<v1::VetoLoopClosureRequest>("m");
  veto.set_id("anna/run:0>bert/run:2#0");
  add("veto_loop_closure", 'v', veto);
  auto force = About<v1::ForceLoopClosureRequest>("m");
  force.set_id("anna/run:0>bert/run:2#0");
  add("force_loop_closure", 'f', force);
  add("list_revisions", 'h', About<v1::ListRevisionsRequest>("m"));
  auto roll_back = About<v1::RollBackRequest>("m");
  roll_back.set_revision(1);
  add("roll_back", 'b', roll_back);
  add("get_trajectory", 't', About<v1::GetTrajectoryRequest>("m"));
  auto export_map = About<v1::ExportMapRequest>("m");
  export_map.set_format(v1::EXPORT_FORMAT_G2O);
  add("export_map", 'x', export_map);
}

void AddUploads(const Corpus& corpus) {
  const MissionId mission = WorldMissions()[0];
  v1::UploadSubmapsRequest header, rich, first, second, blob;
  header.mutable_header()->set_map("m");
  *header.mutable_header()->mutable_mission() = ToProto(mission);
  Submap submap = testing::MakeSubmap(0, 0, 5);
  testing::AddOneOfEach(mission, submap);
  submap.loop_closures.push_back(testing::MakeClosure({mission, 0}, {mission, 4}));
  const std::string cloud = *EncodePointCloud(SmallCloud(false), CloudCodecOptions());
  submap.clouds[0].sha256 = Sha256(cloud);
  submap.clouds[0].encoded_bytes = static_cast<int64_t>(cloud.size());
  *rich.mutable_submap() = ToProto(submap);
  *first.mutable_submap() = ToProto(testing::MakeSubmap(0, 0, 1));
  *second.mutable_submap() = ToProto(testing::MakeSubmap(1, 1, 1));
  blob.mutable_blob()->set_sha256(submap.clouds[0].sha256);
  blob.mutable_blob()->set_data(cloud);
  corpus.Add("uploads", "two_submaps", Framed(header) + Framed(first) + Framed(second));
  corpus.Add("uploads", "one_of_each", Framed(header) + Framed(rich) + Framed(blob));
}

void AddWatchFrames(const Corpus& corpus) {
  std::mt19937 random(1);
  const MapGraph before = testing::MakeGraph(random, 2, 4);
  MapGraph after = before;
  ++after.revision;
  after.missions[0].nodes.pop_back();
  after.missions[1].nodes[1].map_from_body.translation.x() += 0.5;
  after.edges.resize(2);
  for (const bool compact : {false, true}) {
    GraphFormat format;
    format.map = "m";
    format.encoding = compact ? v1::GRAPH_ENCODING_COMPACT : v1::GRAPH_ENCODING_PLAIN;
    format.include_edges = true;
    v1::WatchGraphResponse snapshot, delta;
    *snapshot.mutable_snapshot() = ToProto(before, format);
    *delta.mutable_delta() = MakeDelta(*FromProto(snapshot.snapshot()), after, format);
    corpus.Add("watch_frames", compact ? "compact" : "plain", Framed(snapshot) + Framed(delta));
  }
}

void AddUploadAnswers(const Corpus& corpus) {
  v1::UploadSubmapsResponse ready, ack, want, result, reject;
  ready.mutable_ready()->set_window_bytes(4 << 20);
  ack.mutable_ack()->set_durable_through_sequence(1);
  want.mutable_want()->add_sha256(std::string(32, '0'));
  want.mutable_want()->add_sha256(std::string(32, '2'));
  result.mutable_blob_result()->set_sha256(std::string(32, '0'));
  reject.mutable_reject()->set_sequence(2);
  reject.mutable_reject()->set_code(3);
  corpus.Add("upload_answers", "clouds",
             Framed(ready) + Framed(ack) + Framed(want) + Framed(result));
  corpus.Add("upload_answers", "reject", Framed(ready) + Framed(reject));
}

}  // namespace
}  // namespace overtone::fuzz

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s FOLDER\n", argv[0]);
    return 2;
  }
  const overtone::fuzz::Corpus corpus(argv[1]);
  overtone::fuzz::AddTrajectories(corpus);
  overtone::fuzz::AddGraphFiles(corpus);
  overtone::fuzz::AddClouds(corpus);
  overtone::fuzz::AddRecordings(corpus);
  overtone::fuzz::AddOptions(corpus);
  overtone::fuzz::AddRequests(corpus);
  overtone::fuzz::AddUploads(corpus);
  overtone::fuzz::AddWatchFrames(corpus);
  overtone::fuzz::AddUploadAnswers(corpus);
  return 0;
}
