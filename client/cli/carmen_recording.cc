// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/carmen_recording.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <utility>

#include "absl/strings/str_cat.h"
#include "overtone/client/cli/text_rows.h"
#include "overtone/core/common/parse_number.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {
namespace {

constexpr int64_t kMaxBeams = 4096;
constexpr double kNoReturnShare = 0.99;  // of the longest range of the log
constexpr int64_t kStandingClockNs = 1000;
// Behind the ranges of a FLASER line: pose, odometry pose, ipc_time, host, logger_time.
constexpr size_t kFieldsBehindRanges = 9;

struct Scan {
  std::vector<double> ranges_m;
  Rigid3d pose;
  Timestamp ipc_time;
};

absl::StatusOr<Scan> ParseScan(Fields fields) {
  if (fields.size() < 2) return absl::InvalidArgumentError("a FLASER line without ranges");
  ASSIGN_OR_RETURN(const int64_t beams, ParseNonNegativeInteger(fields[1]));
  if (beams < 1 || beams > kMaxBeams) {
    return absl::InvalidArgumentError(absl::StrCat("a scan of ", beams, " beams"));
  }
  RETURN_IF_ERROR(ExpectFields(fields, 2 + beams + kFieldsBehindRanges));
  Scan scan;
  scan.ranges_m.resize(beams);
  RETURN_IF_ERROR(ParseFiniteDoubles(fields.subspan(2, beams), absl::MakeSpan(scan.ranges_m)));
  const Fields behind = fields.subspan(2 + beams);
  ASSIGN_OR_RETURN(scan.pose, ParsePlanarPose(behind.subspan(3, 3)));
  ASSIGN_OR_RETURN(scan.ipc_time, ParseSeconds(behind[6]));
  return scan;
}

absl::StatusOr<std::vector<Scan>> ReadScans(const std::string& path) {
  std::vector<Scan> scans;
  RETURN_IF_ERROR(ForEachRow(path, [&scans](Fields fields) -> absl::Status {
    if (fields[0] != "FLASER") return absl::OkStatus();
    ASSIGN_OR_RETURN(Scan scan, ParseScan(fields));
    scans.push_back(std::move(scan));
    return absl::OkStatus();
  }));
  if (scans.empty()) return absl::InvalidArgumentError(absl::StrCat(path, ": no FLASER lines"));
  return scans;
}

double LongestRange(const std::vector<Scan>& scans) {
  double longest = 0;
  for (const Scan& scan : scans) {
    longest = std::max(longest, *std::max_element(scan.ranges_m.begin(), scan.ranges_m.end()));
  }
  return longest;
}

PointCloud ToCloud(const Scan& scan, double no_return_m) {
  PointCloud cloud;
  for (size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const double range = scan.ranges_m[i];
    if (!(range > 0 && range < no_return_m)) continue;
    const double angle = M_PI * static_cast<double>(i) / scan.ranges_m.size() - M_PI / 2;
    cloud.points.emplace_back(range * std::cos(angle), range * std::sin(angle), 0);
  }
  return cloud;
}

// In centimetres: the logs differ in how they print.
std::vector<int64_t> Fingerprint(const Scan& scan) {
  std::vector<int64_t> fingerprint;
  for (const double range : scan.ranges_m) fingerprint.push_back(std::llround(100 * range));
  return fingerprint;
}

absl::Status AddReference(const std::string& path, const std::vector<Scan>& scans,
                          Recording* recording) {
  ASSIGN_OR_RETURN(const std::vector<Scan> corrected, ReadScans(path));
  std::map<std::vector<int64_t>, int64_t> frames;  // the first one, should two scans be the same
  for (size_t i = 0; i < scans.size(); ++i) frames.try_emplace(Fingerprint(scans[i]), i);
  std::map<int64_t, Rigid3d> poses;
  for (const Scan& scan : corrected) {
    const auto frame = frames.find(Fingerprint(scan));
    if (frame != frames.end()) poses[frame->second] = scan.pose;
  }
  if (poses.empty()) {
    return absl::InvalidArgumentError(absl::StrCat(path, ": none of its scans is in the raw log"));
  }
  for (const auto& [frame, pose] : poses) {
    recording->ground_truth.push_back({recording->odometry[frame].stamp, pose});
    recording->keyframes.insert(frame);
  }
  recording->common_from_world = Rigid3d::Identity();
  return absl::OkStatus();
}

absl::Status AddRelations(const std::string& path, const std::vector<Scan>& scans,
                          Recording* recording) {
  std::map<Timestamp, int64_t> frames;
  for (size_t i = 0; i < scans.size(); ++i) frames.try_emplace(scans[i].ipc_time, i);
  const auto frame_at = [&frames](absl::string_view text) -> absl::StatusOr<int64_t> {
    ASSIGN_OR_RETURN(const Timestamp time, ParseSeconds(text));
    const auto frame = frames.find(time);
    if (frame != frames.end()) return frame->second;
    return absl::InvalidArgumentError(absl::StrCat("the log has no scan at ", text, " s"));
  };
  return ForEachRow(path, [&](Fields fields) -> absl::Status {
    RETURN_IF_ERROR(ExpectFields(fields, 8));
    FrameClosure relation;
    ASSIGN_OR_RETURN(relation.from_frame, frame_at(fields[0]));
    ASSIGN_OR_RETURN(relation.to_frame, frame_at(fields[1]));
    Vector6d v;  // dx dy dz roll pitch yaw
    RETURN_IF_ERROR(ParseFiniteDoubles(fields.subspan(2), absl::MakeSpan(v.data(), 6)));
    relation.from_tform_to =
        Rigid3d(ExpSO3({0, 0, v[5]}) * ExpSO3({0, v[4], 0}) * ExpSO3({v[3], 0, 0}), v.head<3>());
    recording->relations.push_back(relation);
    recording->keyframes.insert({relation.from_frame, relation.to_frame});
    return absl::OkStatus();
  });
}

}  // namespace

absl::StatusOr<Recording> ReadCarmenRecording(const std::string& log, const std::string& reference,
                                              const std::string& relations) {
  Recording recording;
  recording.name = std::filesystem::path(log).stem().string();
  ASSIGN_OR_RETURN(recording.id, MissionOf(recording.name));
  ASSIGN_OR_RETURN(const std::vector<Scan> scans, ReadScans(log));
  const double no_return_m = kNoReturnShare * LongestRange(scans);
  const Rigid3d mission_from_log = scans[0].pose.Inverse();
  Timestamp stamp = scans[0].ipc_time;
  for (size_t i = 0; i < scans.size(); ++i) {
    if (i > 0) stamp = std::max(scans[i].ipc_time, Timestamp{stamp.ns + kStandingClockNs});
    recording.odometry.push_back({stamp, mission_from_log * scans[i].pose});
    recording.frames.push_back(static_cast<int64_t>(i));
    recording.observations.clouds.push_back(
        {static_cast<int64_t>(i), "",
         std::make_shared<const PointCloud>(ToCloud(scans[i], no_return_m))});
  }
  if (!reference.empty()) RETURN_IF_ERROR(AddReference(reference, scans, &recording));
  if (!relations.empty()) RETURN_IF_ERROR(AddRelations(relations, scans, &recording));
  return recording;
}

}  // namespace overtone
