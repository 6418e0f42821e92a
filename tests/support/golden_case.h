// SPDX-License-Identifier: Apache-2.0
// Reads the golden vectors: CSV tables, bare matrices and pose lists. Test code: a missing or
// broken file throws. Conventions of the files: tests/data/README.md.
#ifndef OVERTONE_TESTS_SUPPORT_GOLDEN_CASE_H_
#define OVERTONE_TESTS_SUPPORT_GOLDEN_CASE_H_

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "Eigen/Core"
#include "nlohmann/json.hpp"
#include "overtone/core/common/timestamp.h"
#include "overtone/core/spectral/edge_weights.h"

namespace overtone::golden {

inline std::vector<std::string> SplitLine(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
  return cells;
}

inline std::vector<std::vector<std::string>> ReadRows(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot open " + path.string());
  std::vector<std::vector<std::string>> rows;
  for (std::string line; std::getline(file, line);) {
    if (!line.empty()) rows.push_back(SplitLine(line));
  }
  return rows;
}

// A file with one header line.
class Table {
 public:
  explicit Table(const std::filesystem::path& path) : rows_(ReadRows(path)), header_(rows_.at(0)) {
    rows_.erase(rows_.begin());
  }

  int num_rows() const { return static_cast<int>(rows_.size()); }
  const std::vector<std::string>& header() const { return header_; }
  const std::string& Cell(int row, const std::string& column) const {
    const auto found = std::find(header_.begin(), header_.end(), column);
    if (found == header_.end()) throw std::runtime_error("no column " + column);
    return rows_.at(row).at(found - header_.begin());
  }
  double Number(int row, const std::string& column) const { return std::stod(Cell(row, column)); }
  int Integer(int row, const std::string& column) const { return std::stoi(Cell(row, column)); }
  Eigen::VectorXd Column(const std::string& column) const {
    Eigen::VectorXd values(num_rows());
    for (int row = 0; row < num_rows(); ++row) values[row] = Number(row, column);
    return values;
  }
  // Columns prefix0, prefix1, ..., as many as there are.
  Eigen::MatrixXd Columns(const std::string& prefix) const {
    int count = 0;
    while (std::count(header_.begin(), header_.end(), prefix + std::to_string(count)) > 0) ++count;
    Eigen::MatrixXd values(num_rows(), count);
    for (int i = 0; i < count; ++i) values.col(i) = Column(prefix + std::to_string(i));
    return values;
  }

 private:
  std::vector<std::vector<std::string>> rows_;
  std::vector<std::string> header_;
};

// A file without a header line.
inline Eigen::MatrixXd ReadMatrix(const std::filesystem::path& path) {
  const auto rows = ReadRows(path);
  Eigen::MatrixXd matrix(rows.size(), rows.at(0).size());
  for (size_t i = 0; i < rows.size(); ++i) {
    for (size_t j = 0; j < rows[i].size(); ++j) matrix(i, j) = std::stod(rows[i][j]);
  }
  return matrix;
}

struct Pose {
  Timestamp stamp;
  int submap_id = 0;
  Rigid3d map_from_body;
};

inline std::vector<Pose> ReadPoses(const std::filesystem::path& path) {
  const Table table(path);
  std::vector<Pose> poses;
  for (int row = 0; row < table.num_rows(); ++row) {
    const auto at = [&](const char* column) { return table.Number(row, column); };
    Pose pose;
    pose.stamp.ns = std::stoll(table.Cell(row, "t_ns"));
    pose.submap_id = table.Integer(row, "submap_id");
    pose.map_from_body = Rigid3d(Eigen::Quaterniond(at("qw"), at("qx"), at("qy"), at("qz")),
                                 Eigen::Vector3d(at("x"), at("y"), at("z")));
    poses.push_back(pose);
  }
  return poses;
}

inline std::vector<Rigid3d> Rigid(const std::vector<Pose>& poses) {
  std::vector<Rigid3d> rigid;
  for (const Pose& pose : poses) rigid.push_back(pose.map_from_body);
  return rigid;
}

// One folder `<trajectory>_r<radius>_<method>`, method se3, r3 or so3 (the trace similarity).
struct Case {
  std::filesystem::path folder;
  nlohmann::json meta;

  std::string name() const { return folder.filename().string(); }
  std::filesystem::path File(const std::string& file) const { return folder / file; }
  bool Has(const std::string& file) const { return std::filesystem::exists(File(file)); }
  int num_nodes() const { return meta.at("N").get<int>(); }
  double lmax() const { return meta.at("lmax").get<double>(); }
  RadiusGraphOptions graph_options() const {
    RadiusGraphOptions options;
    options.radius_m = meta.at("radius_m").get<double>();
    options.sigma = meta.at("sigma").get<double>();
    const std::string method = meta.at("method").get<std::string>();
    options.metric = method == "se3"  ? DistanceMetric::kSe3
                     : method == "r3" ? DistanceMetric::kR3
                                      : DistanceMetric::kSo3Trace;
    return options;
  }
};

// The vectors in the tree, and the folder with all of them: OVERTONE_TEST_GOLDEN_DIR, default
// ../shared/golden.
inline std::filesystem::path CommittedFolder() {
  return std::filesystem::path(OVERTONE_SOURCE_DIR) / "tests/data/golden";
}
inline std::filesystem::path SharedFolder() {
  const char* folder = std::getenv("OVERTONE_TEST_GOLDEN_DIR");
  return folder ? std::filesystem::path(folder)
                : std::filesystem::path(OVERTONE_SOURCE_DIR) / "../shared/golden";
}

// All cases in `folder` by name; none where it is absent.
inline std::vector<Case> CasesIn(const std::filesystem::path& folder) {
  std::vector<Case> cases;
  if (!std::filesystem::is_directory(folder)) return cases;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    const size_t radius = name.find("_r");
    if (!entry.is_directory() || radius == std::string::npos ||
        name.find('_', radius + 1) == std::string::npos) {
      continue;
    }
    std::ifstream meta(entry.path() / "meta.json");
    if (meta) cases.push_back({entry.path(), nlohmann::json::parse(meta)});
  }
  std::sort(cases.begin(), cases.end(),
            [](const Case& a, const Case& b) { return a.folder < b.folder; });
  return cases;
}

}  // namespace overtone::golden

#endif  // OVERTONE_TESTS_SUPPORT_GOLDEN_CASE_H_
