// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/geometry/trajectory_io.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <initializer_list>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "overtone/core/common/format_number.h"
#include "overtone/core/common/line_reader.h"
#include "overtone/core/common/parse_number.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/geometry/parse_pose.h"

namespace overtone {
namespace {

using Fields = std::vector<absl::string_view>;

absl::Status CheckFieldCount(const Fields& fields, size_t expected, absl::string_view columns) {
  if (fields.size() == expected) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat(fields.size(), " fields where ", expected, " are expected: ", columns));
}

absl::StatusOr<StampedPose> ParseTumRow(absl::string_view line) {
  const Fields fields = absl::StrSplit(line, absl::ByAnyChar(" \t"), absl::SkipEmpty());
  RETURN_IF_ERROR(CheckFieldCount(fields, 8, "t x y z qx qy qz qw"));
  StampedPose row;
  ASSIGN_OR_RETURN(row.stamp, ParseSeconds(fields[0]));
  ASSIGN_OR_RETURN(row.pose, ParsePose(absl::MakeConstSpan(fields).subspan(1)));
  return row;
}

// `columns`: how many the first row has; 0 before it. A row cut short differs from the first.
absl::StatusOr<StampedPose> ParseEurocRow(absl::string_view line, size_t& columns) {
  const Fields fields = absl::StrSplit(line, ',');
  constexpr absl::string_view kColumns = "t x y z qw qx qy qz";
  if (columns == 0) columns = std::max<size_t>(fields.size(), 8);
  RETURN_IF_ERROR(CheckFieldCount(fields, columns, kColumns));
  StampedPose row;
  if (!absl::SimpleAtoi(fields[0], &row.stamp.ns)) {
    return absl::InvalidArgumentError("the stamp is not an integer of nanoseconds");
  }
  const std::array<absl::string_view, 7> pose = {fields[1], fields[2], fields[3], fields[5],
                                                 fields[6], fields[7], fields[4]};
  ASSIGN_OR_RETURN(row.pose, ParsePose(pose));
  return row;
}

absl::StatusOr<StampedPose> ParseKittiRow(absl::string_view line, size_t index,
                                          double row_rate_hz) {
  const Fields fields = absl::StrSplit(line, absl::ByAnyChar(" \t"), absl::SkipEmpty());
  RETURN_IF_ERROR(CheckFieldCount(fields, 12, "a row-major 3 x 4 matrix"));
  Eigen::Matrix<double, 3, 4, Eigen::RowMajor> matrix;
  RETURN_IF_ERROR(ParseFiniteDoubles(fields, absl::MakeSpan(matrix.data(), 12)));
  StampedPose row;
  row.stamp.ns = std::llround(static_cast<double>(index) * (1e9 / row_rate_hz));
  ASSIGN_OR_RETURN(row.pose, CheckedPose(matrix));
  return row;
}

void WriteRow(std::ostream& out, char separator, std::initializer_list<double> numbers) {
  bool first = true;
  for (const double number : numbers) {
    if (!first) out << separator;
    out << FormatDouble(number);
    first = false;
  }
  out << '\n';
}

}  // namespace

absl::StatusOr<Trajectory> ReadTrajectory(std::istream& in, absl::string_view name,
                                          TrajectoryFormat format, double row_rate_hz) {
  // Slower, row numbers would leave int64 nanoseconds; faster, rows would share one.
  if (!(row_rate_hz >= 1e-3 && row_rate_hz <= 1e9)) {
    return absl::InvalidArgumentError(
        absl::StrCat("row_rate_hz: ", row_rate_hz, " is not in [0.001, 1e9]"));
  }
  Trajectory trajectory;
  LineReader reader(in, name);
  absl::string_view line;
  size_t euroc_columns = 0;
  while (reader.Next(&line)) {
    const auto row = format == TrajectoryFormat::kTum ? ParseTumRow(line)
                     : format == TrajectoryFormat::kEuroc
                         ? ParseEurocRow(line, euroc_columns)
                         : ParseKittiRow(line, trajectory.size(), row_rate_hz);
    if (!row.ok()) return reader.Error(row.status().message());
    if (!trajectory.empty() && row->stamp <= trajectory.back().stamp) {
      return reader.Error(absl::StrCat("time does not increase: ", row->stamp.ns, " ns after ",
                                       trajectory.back().stamp.ns, " ns"));
    }
    trajectory.push_back(*row);
  }
  RETURN_IF_ERROR(reader.status());
  if (trajectory.empty()) return absl::InvalidArgumentError(absl::StrCat(name, ": no poses"));
  return trajectory;
}

absl::StatusOr<Trajectory> ReadTrajectory(const std::string& path, TrajectoryFormat format,
                                          double row_rate_hz) {
  std::ifstream file(path);
  if (!file) return absl::NotFoundError(absl::StrCat(path, ": cannot be opened"));
  return ReadTrajectory(file, path, format, row_rate_hz);
}

void WriteTrajectory(std::ostream& out, TrajectoryFormat format, const Trajectory& trajectory) {
  if (format == TrajectoryFormat::kTum) out << "# t[s] x y z qx qy qz qw\n";
  if (format == TrajectoryFormat::kEuroc) out << "#t[ns],x,y,z,qw,qx,qy,qz\n";
  for (const auto& [stamp, pose] : trajectory) {
    const Eigen::Vector3d& p = pose.translation;
    const Eigen::Quaterniond& q = pose.rotation;
    if (format == TrajectoryFormat::kTum) {
      out << FormatSeconds(stamp) << ' ';
      WriteRow(out, ' ', {p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()});
    } else if (format == TrajectoryFormat::kEuroc) {
      out << stamp.ns << ',';
      WriteRow(out, ',', {p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()});
    } else {
      const Eigen::Matrix3d r = q.toRotationMatrix();
      WriteRow(out, ' ',
               {r(0, 0), r(0, 1), r(0, 2), p.x(), r(1, 0), r(1, 1), r(1, 2), p.y(), r(2, 0),
                r(2, 1), r(2, 2), p.z()});
    }
  }
}

absl::Status WriteTrajectory(const std::string& path, TrajectoryFormat format,
                             const Trajectory& trajectory) {
  std::ofstream file(path);
  WriteTrajectory(file, format, trajectory);
  file.flush();
  if (!file) return absl::UnavailableError(absl::StrCat(path, ": cannot be written"));
  return absl::OkStatus();
}

}  // namespace overtone
