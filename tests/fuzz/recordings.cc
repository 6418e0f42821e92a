// SPDX-License-Identifier: Apache-2.0
// The recordings, closures and alignments that the command line reads. The first byte says which,
// the rest is their files.
#include "overtone/client/cli/carmen_recording.h"
#include "overtone/client/cli/closure_file.h"
#include "overtone/client/cli/g2o_recording.h"
#include "overtone/client/cli/mrclam_recording.h"
#include "overtone/client/cli/pcd_recording.h"
#include "overtone/client/cli/robot_recording_file.h"
#include "overtone/client/cli/tuc_recording.h"
#include "overtone/tests/fuzz/memory_file.h"

namespace overtone::fuzz {
namespace {

constexpr double kMinCandidateScore = 0.5;

// What every reader promises: a name, a frame number for each pose, observations of frames that are
// there.
void CheckRecording(const Recording& recording) {
  FUZZ_CHECK(!recording.odometry.empty(), "no odometry");
  FUZZ_CHECK(recording.frames.size() == recording.odometry.size(), "not a frame for each pose");
  FUZZ_CHECK(recording.motion_covariances.empty() ||
                 recording.motion_covariances.size() == recording.odometry.size(),
             "not a covariance for each pose");
  for (size_t i = 1; i < recording.odometry.size(); ++i) {
    FUZZ_CHECK(recording.odometry[i - 1].stamp < recording.odometry[i].stamp,
               "stamps do not increase");
    FUZZ_CHECK(recording.frames[i - 1] < recording.frames[i], "frames do not increase");
  }
}

void CheckRecordings(const absl::StatusOr<std::vector<Recording>>& recordings) {
  if (!recordings.ok()) return;
  for (const Recording& recording : *recordings) CheckRecording(recording);
}

void Carmen(const std::vector<std::string>& files) {
  static const MemoryFolder folder("carmen");
  folder.Replace({"robot.log", "reference.log", "relations"}, files);
  const auto path = [&](size_t i, const char* name) {
    return i < files.size() ? folder.path() + "/" + name : std::string();
  };
  const auto recording = ReadCarmenRecording(folder.path() + "/robot.log", path(1, "reference.log"),
                                             path(2, "relations"));
  if (recording.ok()) CheckRecording(*recording);
}

void Mrclam(const std::vector<std::string>& files) {
  static const MemoryFolder folder("mrclam");
  folder.Replace(
      {"Robot1_Odometry.dat", "Robot1_Measurement.dat", "Barcodes.dat", "Robot1_Groundtruth.dat"},
      files);
  CheckRecordings(ReadMrclamRecordings(folder.path()));
}

void Tuc(const std::vector<std::string>& files) {
  static const MemoryFolder folder("tuc");
  folder.Replace({"run_Input.txt", "run_GT.txt"}, files);
  const auto recording = ReadTucRecording(folder.path(), kMinCandidateScore);
  if (recording.ok()) CheckRecording(*recording);
}

void Pcd(const std::vector<std::string>& files) {
  static const MemoryFolder folder("pcd");
  static const MemoryFolder scans("pcd/Scans");
  // Read when they are needed, and only looked for here.
  for (const char* scan : {"000000.pcd", "000001.pcd", "000002.pcd"}) scans.Write(scan, "");
  folder.Replace({"odom_poses.txt", "times.txt", "ground_truth.txt", "degenerate.txt"}, files);
  CheckRecordings(ReadPcdRecordings(folder.path()));
}

void G2o(const std::vector<std::string>& files) {
  const MemoryFile file(files[0]);
  const auto recording = ReadG2oRecording(file.path());
  if (recording.ok()) CheckRecording(*recording);
  (void)ReadG2oClosures(file.path(), /*kitti_camera=*/true);
}

// The robots that closures may be about: ten keyframes along x, two seconds apart.
std::vector<RobotPlan> TwoPlans() {
  std::vector<RobotPlan> plans;
  for (const char* name : {"anna", "bert"}) {
    Recording recording;
    recording.name = name;
    recording.id = {name, "run"};
    for (int i = 0; i < 10; ++i) {
      StampedPose pose{{(1 + 2 * i) * int64_t{1'000'000'000}}, Rigid3d()};
      pose.pose.translation.x() = i;
      recording.odometry.push_back(pose);
      recording.frames.push_back(i);
      recording.keyframes.insert(i);
    }
    auto plan = MakeRobotPlan(recording, {}, {});
    FUZZ_CHECK(plan.ok(), plan.status().ToString());
    plans.push_back(*std::move(plan));
  }
  return plans;
}

void Closures(const std::vector<std::string>& files) {
  static const auto* plans = new std::vector<RobotPlan>(TwoPlans());
  const auto closures = ReadClosures(MemoryFile(files[0]).path(), *plans);
  if (!closures.ok()) return;
  for (const LoopClosure& closure : *closures) {
    for (const NodeId& end : {closure.from, closure.to}) {
      FUZZ_CHECK(end.index >= 0 && end.index < 10, "no such keyframe");
    }
  }
}

void RobotFile(const std::vector<std::string>& files) {
  const auto recording = ReadRobotRecording(MemoryFile(files[0]).path());
  if (!recording.ok()) return;
  // What is written of it reads back.
  const MemoryFile written("");
  FUZZ_CHECK(WriteRobotRecording(written.path(), *recording).ok(), "cannot be written");
  const auto again = ReadRobotRecording(written.path());
  FUZZ_CHECK(again.ok(), again.status().ToString());
  FUZZ_CHECK(again->keyframes.size() == recording->keyframes.size(), "keyframes are lost");
}

void Run(absl::string_view input) {
  const uint8_t kind = TakeSelector(input);
  const std::vector<std::string> files = Files(input);
  switch (kind) {
    case 'c':
      return Carmen(files);
    case 'm':
      return Mrclam(files);
    case 't':
      return Tuc(files);
    case 'p':
      return Pcd(files);
    case 'g':
      return G2o(files);
    case 'l':
      return Closures(files);
    case 'r':
      return RobotFile(files);
    default:
      (void)ReadAlignment(MemoryFile(files[0]).path());
  }
}

}  // namespace
}  // namespace overtone::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  overtone::fuzz::Run(overtone::fuzz::AsText(data, size));
  return 0;
}
