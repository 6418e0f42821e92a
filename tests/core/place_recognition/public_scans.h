// SPDX-License-Identifier: Apache-2.0
// Real scans with poses, read from beside the project and never part of it.
#ifndef OVERTONE_TESTS_CORE_PLACE_RECOGNITION_PUBLIC_SCANS_H_
#define OVERTONE_TESTS_CORE_PLACE_RECOGNITION_PUBLIC_SCANS_H_

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "overtone/core/graph/point_cloud_io.h"
#include "overtone/core/place_recognition/cloud_gathering.h"

namespace overtone {

struct PublicScans {
  std::vector<double> seconds;
  std::vector<CloudAtPose> keyframes;  // with odometry
  std::vector<Rigid3d> truth;          // map_from_body
};

// A handheld Livox Avia (70 x 77 degrees) outdoors. The truth is its odometry, which closes to
// 0.06 m.
inline PublicScans ReadHkuLivox(const std::string& folder) {
  PublicScans scans;
  std::ifstream poses(folder + "/odom_poses.txt");
  std::ifstream times(folder + "/times.txt");
  for (double seconds; times >> seconds;) {
    Eigen::Matrix<double, 3, 4, Eigen::RowMajor> matrix;
    for (int i = 0; i < 12; ++i) poses >> matrix.data()[i];
    const Eigen::Matrix3d rotation = matrix.leftCols<3>();
    const Rigid3d pose(Eigen::Quaterniond(rotation).normalized(), matrix.col(3));
    char name[32];
    std::snprintf(name, sizeof(name), "/Scans/%06zu.pcd", scans.truth.size());
    const auto cloud = ReadPointCloud(folder + name);
    scans.seconds.push_back(seconds);
    scans.truth.push_back(pose);
    scans.keyframes.push_back({pose, cloud.ok() ? std::make_shared<PointCloud>(*cloud) : nullptr});
  }
  return scans;
}

// One FLASER line of a CARMEN log: 180 ranges over 180 degrees, then two poses and three times.
struct FlaserLine {
  std::string ranges;  // in centimetres: the same scan in both logs
  std::shared_ptr<PointCloud> cloud = std::make_shared<PointCloud>();
  Rigid3d pose;
  double seconds = 0;
};

inline std::vector<FlaserLine> ReadFlaser(const std::string& path, double no_return_m) {
  std::vector<FlaserLine> scans;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string word;
    int beams = 0;
    if (!(words >> word >> beams) || word != "FLASER") continue;
    FlaserLine scan;
    for (int beam = 0; beam < beams; ++beam) {
      double range = 0;
      words >> range;
      scan.ranges += std::to_string(std::lround(100 * range)) + ' ';
      const double bearing = M_PI * ((beam + 0.5) / beams - 0.5);
      if (range >= no_return_m) continue;
      scan.cloud->points.emplace_back(range * std::cos(bearing), range * std::sin(bearing), 0);
    }
    double x, y, heading, skipped;
    words >> x >> y >> heading >> skipped >> skipped >> skipped >> scan.seconds;
    scan.pose = Rigid3d(Eigen::Quaterniond(Eigen::AngleAxisd(heading, Eigen::Vector3d::UnitZ())),
                        {x, y, 0});
    scans.push_back(scan);
  }
  return scans;
}

// A planar laser indoors, with wheel odometry. The keyframes are the scans of the corrected log,
// every 0.5 to 0.7 m, which carry the truth.
inline PublicScans ReadRadish(const std::string& folder, const std::string& name,
                              double no_return_m) {
  std::map<std::string, Rigid3d> truth;
  for (const FlaserLine& scan : ReadFlaser(folder + '/' + name + "-corrected.log", no_return_m)) {
    truth[scan.ranges] = scan.pose;
  }
  PublicScans scans;
  for (const FlaserLine& scan : ReadFlaser(folder + '/' + name + ".clf", no_return_m)) {
    const auto corrected = truth.find(scan.ranges);
    if (corrected == truth.end()) continue;
    if (!scans.seconds.empty() && scan.seconds <= scans.seconds.back()) continue;
    scans.seconds.push_back(scan.seconds);
    scans.keyframes.push_back({scan.pose, scan.cloud});
    scans.truth.push_back(corrected->second);
  }
  return scans;
}

}  // namespace overtone

#endif  // OVERTONE_TESTS_CORE_PLACE_RECOGNITION_PUBLIC_SCANS_H_
