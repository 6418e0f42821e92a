// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/mrclam_recording.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <numeric>
#include <utility>

#include "absl/strings/str_cat.h"
#include "overtone/client/cli/text_rows.h"
#include "overtone/client/cli/velocity_odometry.h"
#include "overtone/core/common/parse_number.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {
namespace {

constexpr int kRobotSubjects = 5;          // 1 to 5 are robots, those above are landmarks
constexpr int64_t kOneLookNs = 5'000'000;  // what one image shows bears stamps this close
constexpr double kMaxRange_m = 1000;       // beyond, a number is a defect

using Subjects = std::map<int64_t, int64_t>;  // by barcode

struct Measurement {
  Timestamp stamp;
  int64_t barcode = 0;
  double range_m = 0;
  double bearing_rad = 0;
};

bool Exists(const std::string& path) {
  std::error_code ignored;
  return std::filesystem::exists(path, ignored);
}

absl::StatusOr<Subjects> ReadBarcodes(const std::string& path) {
  Subjects subjects;
  RETURN_IF_ERROR(ForEachRow(path, [&subjects](Fields fields) -> absl::Status {
    RETURN_IF_ERROR(ExpectFields(fields, 2));
    ASSIGN_OR_RETURN(const int64_t subject, ParseNonNegativeInteger(fields[0]));
    ASSIGN_OR_RETURN(const int64_t barcode, ParseNonNegativeInteger(fields[1]));
    if (!subjects.emplace(barcode, subject).second) {
      return absl::InvalidArgumentError(absl::StrCat("barcode ", barcode, " is given twice"));
    }
    return absl::OkStatus();
  }));
  return subjects;
}

absl::StatusOr<std::vector<PlanarVelocity>> ReadVelocities(const std::string& path) {
  std::vector<PlanarVelocity> velocities;
  RETURN_IF_ERROR(ForEachRow(path, [&velocities](Fields fields) -> absl::Status {
    RETURN_IF_ERROR(ExpectFields(fields, 3));
    PlanarVelocity row;
    ASSIGN_OR_RETURN(row.stamp, ParseSeconds(fields[0]));
    ASSIGN_OR_RETURN(row.ahead_m_per_s, ParseFiniteDouble(fields[1]));
    ASSIGN_OR_RETURN(row.turn_rad_per_s, ParseFiniteDouble(fields[2]));
    return AppendVelocity(row, &velocities);
  }));
  if (velocities.empty()) return absl::InvalidArgumentError(absl::StrCat(path, ": no odometry"));
  return velocities;
}

// Those of one image are put on its first stamp.
absl::StatusOr<std::vector<Measurement>> ReadMeasurements(const std::string& path) {
  std::vector<Measurement> measurements;
  RETURN_IF_ERROR(ForEachRow(path, [&measurements](Fields fields) -> absl::Status {
    RETURN_IF_ERROR(ExpectFields(fields, 4));
    Measurement row;
    ASSIGN_OR_RETURN(row.stamp, ParseSeconds(fields[0]));
    ASSIGN_OR_RETURN(row.barcode, ParseNonNegativeInteger(fields[1]));
    ASSIGN_OR_RETURN(row.range_m, ParseFiniteDouble(fields[2]));
    ASSIGN_OR_RETURN(row.bearing_rad, ParseFiniteDouble(fields[3]));
    if (!(row.range_m > 0 && row.range_m <= kMaxRange_m)) {
      return absl::InvalidArgumentError(absl::StrCat("a range of ", row.range_m, " m"));
    }
    if (!measurements.empty()) {
      const Timestamp previous = measurements.back().stamp;
      if (row.stamp < previous) return absl::InvalidArgumentError("the time runs back");
      if (row.stamp.ns - previous.ns <= kOneLookNs) row.stamp = previous;
    }
    measurements.push_back(row);
    return absl::OkStatus();
  }));
  return measurements;
}

absl::StatusOr<Trajectory> ReadGroundTruth(const std::string& path) {
  Trajectory trajectory;
  RETURN_IF_ERROR(ForEachRow(path, [&trajectory](Fields fields) -> absl::Status {
    RETURN_IF_ERROR(ExpectFields(fields, 4));
    StampedPose row;
    ASSIGN_OR_RETURN(row.stamp, ParseSeconds(fields[0]));
    ASSIGN_OR_RETURN(row.pose, ParsePlanarPose(fields.subspan(1)));
    if (!trajectory.empty() && row.stamp <= trajectory.back().stamp) {
      return absl::InvalidArgumentError("the time does not increase");
    }
    trajectory.push_back(row);
    return absl::OkStatus();
  }));
  return trajectory;
}

Eigen::Vector3d PointOf(const Measurement& measurement) {
  return {measurement.range_m * std::cos(measurement.bearing_rad),
          measurement.range_m * std::sin(measurement.bearing_rad), 0};
}

// Range and bearing are off independently; turned into the body's axes.
Eigen::Matrix3d CovarianceOf(const Measurement& measurement) {
  const Eigen::Vector3d sigmas(kMrclamRangeSigma_m, kMrclamBearingSigma_rad * measurement.range_m,
                               kMrclamVerticalSigma_m);
  const Eigen::Matrix3d body_from_ray = ExpSO3({0, 0, measurement.bearing_rad}).toRotationMatrix();
  return body_from_ray * sigmas.cwiseAbs2().asDiagonal() * body_from_ray.transpose();
}

// Every measurement at its own frame, which becomes a keyframe.
void AddSightings(const std::vector<Measurement>& measurements, const Subjects& subjects,
                  int64_t robot, Recording* recording) {
  const std::vector<Timestamp> stamps = Stamps(recording->odometry);
  int ignored = 0;
  for (const Measurement& measurement : measurements) {
    const auto subject = subjects.find(measurement.barcode);
    const auto row = std::lower_bound(stamps.begin(), stamps.end(), measurement.stamp);
    if (subject == subjects.end() || subject->second == robot || row == stamps.end() ||
        *row != measurement.stamp) {
      ++ignored;
      continue;
    }
    const int64_t frame = row - stamps.begin();
    recording->keyframes.insert(frame);
    const Eigen::Vector3d point = PointOf(measurement);
    if (subject->second <= kRobotSubjects) {
      recording->observations.robot_sightings.push_back(
          {frame, absl::StrCat("robot", subject->second), point, CovarianceOf(measurement)});
    } else {
      recording->observations.landmark_sightings.push_back(
          {frame, absl::StrCat("landmark", subject->second), point, CovarianceOf(measurement)});
    }
  }
  if (ignored > 0) {
    recording->note = absl::StrCat(ignored, " sightings of unknown barcodes, of the robot itself ",
                                   "or outside its odometry were ignored");
  }
}

absl::StatusOr<Recording> ReadRobot(const std::string& folder, int robot,
                                    const Subjects& subjects) {
  const std::string prefix = absl::StrCat(folder, "/Robot", robot);
  Recording recording;
  recording.name = absl::StrCat("robot", robot);
  ASSIGN_OR_RETURN(recording.id, MissionOf(recording.name));
  ASSIGN_OR_RETURN(const std::vector<PlanarVelocity> velocities,
                   ReadVelocities(prefix + "_Odometry.dat"));
  ASSIGN_OR_RETURN(const std::vector<Measurement> measurements,
                   ReadMeasurements(prefix + "_Measurement.dat"));
  std::vector<Timestamp> looks;
  for (const Measurement& measurement : measurements) looks.push_back(measurement.stamp);
  ASSIGN_OR_RETURN(recording.odometry, IntegrateVelocities(velocities, looks));
  recording.frames.resize(recording.odometry.size());
  std::iota(recording.frames.begin(), recording.frames.end(), 0);
  AddSightings(measurements, subjects, robot, &recording);
  const std::string ground_truth = prefix + "_Groundtruth.dat";
  if (Exists(ground_truth)) {
    ASSIGN_OR_RETURN(recording.ground_truth, ReadGroundTruth(ground_truth));
    recording.common_from_world = Rigid3d::Identity();
  }
  return recording;
}

}  // namespace

absl::StatusOr<std::vector<Recording>> ReadMrclamRecordings(const std::string& folder) {
  ASSIGN_OR_RETURN(const Subjects subjects, ReadBarcodes(folder + "/Barcodes.dat"));
  std::vector<Recording> recordings;
  for (int robot = 1; robot <= kRobotSubjects; ++robot) {
    const std::string odometry = absl::StrCat(folder, "/Robot", robot, "_Odometry.dat");
    if (robot > 1 && !Exists(odometry)) break;
    ASSIGN_OR_RETURN(Recording recording, ReadRobot(folder, robot, subjects));
    recordings.push_back(std::move(recording));
  }
  return recordings;
}

}  // namespace overtone
