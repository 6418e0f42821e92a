// SPDX-License-Identifier: Apache-2.0
#include "overtone/proto/conversion/graph_columns.h"

#include <array>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/field_path.h"
#include "overtone/proto/conversion/geometry_conversion.h"
#include "overtone/proto/conversion/id_conversion.h"
#include "overtone/proto/conversion/limits.h"

namespace overtone {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr uint32_t kSubmapStart = 1;
constexpr uint32_t kDegenerate = 2;

// One node in units of the columns: index, stamp, x, y, z, rx, ry, rz.
constexpr int kNumColumns = 8;
using Row = std::array<int64_t, kNumColumns>;
using Column = google::protobuf::RepeatedField<int64_t>;

// Rounds to the nearest unit, or towards zero where rounding would leave the ball of radius pi: a
// longer rotation vector stands for a rotation whose logarithm is another one.
Eigen::Vector3d RotationUnits(const Eigen::Quaterniond& rotation, double unit_rad) {
  const Eigen::Vector3d exact = LogSO3(rotation) / unit_rad;
  const Eigen::Vector3d nearest = exact.array().round();
  if (nearest.norm() * unit_rad < kPi) return nearest;
  return exact.unaryExpr([](double x) { return std::trunc(x); });
}

int64_t RoundedDivision(int64_t value, int64_t unit) {  // value >= 0
  return value / unit + (value % unit + unit / 2) / unit;
}

Row ToRow(const MapNode& node, const ColumnUnits& units) {
  const Eigen::Vector3d& position = node.map_from_body.translation;
  const Eigen::Vector3d rotation = RotationUnits(node.map_from_body.rotation, units.rotation_rad);
  return {node.index,
          RoundedDivision(node.stamp.ns, units.stamp_ns),
          std::llround(position.x() / units.position_m),
          std::llround(position.y() / units.position_m),
          std::llround(position.z() / units.position_m),
          std::llround(rotation.x()),
          std::llround(rotation.y()),
          std::llround(rotation.z())};
}

uint32_t Flags(const MapNode& node) {
  return (node.submap_start ? kSubmapStart : 0) | (node.degenerate ? kDegenerate : 0);
}

absl::StatusOr<MapNode> FromRow(const Row& row, uint32_t flags, const ColumnUnits& units) {
  MapNode node;
  node.index = row[0];
  RETURN_IF_ERROR(ValidateKeyframeIndex(node.index, "index"));
  int64_t stamp_ns = 0;
  if (__builtin_mul_overflow(row[1], units.stamp_ns, &stamp_ns)) {
    return InvalidField("stamp", "overflows");
  }
  ASSIGN_OR_RETURN(node.stamp, StampFromNanoseconds(stamp_ns, "stamp"));
  node.map_from_body.translation = Eigen::Vector3d(row[2], row[3], row[4]) * units.position_m;
  RETURN_IF_ERROR(ValidatePosition(node.map_from_body.translation));
  const Eigen::Vector3d rotation = Eigen::Vector3d(row[5], row[6], row[7]) * units.rotation_rad;
  if (!(rotation.norm() <= kPi)) {
    return InvalidField("rx", "a rotation vector is longer than pi");
  }
  node.map_from_body.rotation = ExpSO3(rotation);
  if (flags > (kSubmapStart | kDegenerate)) return InvalidField("flags", "unknown bit");
  node.submap_start = (flags & kSubmapStart) != 0;
  node.degenerate = (flags & kDegenerate) != 0;
  return node;
}

std::array<const Column*, kNumColumns> Columns(const v1::NodeColumns& columns) {
  return {&columns.index(), &columns.stamp(), &columns.x(),  &columns.y(),
          &columns.z(),     &columns.rx(),    &columns.ry(), &columns.rz()};
}

std::array<Column*, kNumColumns> MutableColumns(v1::NodeColumns& columns) {
  return {columns.mutable_index(), columns.mutable_stamp(), columns.mutable_x(),
          columns.mutable_y(),     columns.mutable_z(),     columns.mutable_rx(),
          columns.mutable_ry(),    columns.mutable_rz()};
}

constexpr absl::string_view kColumnNames[kNumColumns] = {"index", "stamp", "x",  "y",
                                                         "z",     "rx",    "ry", "rz"};

absl::Status ValidateLengths(const v1::NodeColumns& columns) {
  const int count = columns.index_size();
  for (int c = 0; c < kNumColumns; ++c) {
    const int size = Columns(columns)[c]->size();
    if (size == count) continue;
    return InvalidField(kColumnNames[c], absl::StrCat(size, " entries, index has ", count));
  }
  if (columns.flags_size() == 0 || columns.flags_size() == count) return absl::OkStatus();
  return InvalidField("flags", absl::StrCat(columns.flags_size(), " entries, not 0 or ", count));
}

}  // namespace

absl::Status ColumnUnits::Validate() const {
  if (!(position_m > 0 && position_m <= limits::kMaxPositionResolutionM)) {
    return InvalidField("position_resolution_m", absl::StrCat(position_m, " is not in (0, 1]"));
  }
  if (!(rotation_rad > 0 && rotation_rad <= limits::kMaxRotationResolutionRad)) {
    return InvalidField("rotation_resolution_rad",
                        absl::StrCat(rotation_rad, " is not in (0, 0.1]"));
  }
  if (stamp_ns < 1 || stamp_ns > limits::kMaxStampResolutionNs) {
    return InvalidField("stamp_resolution_ns", absl::StrCat(stamp_ns, " is not in [1, 1e9]"));
  }
  return absl::OkStatus();
}

v1::NodeColumns EncodeColumns(const std::vector<MapNode>& nodes, const ColumnUnits& units) {
  v1::NodeColumns columns;
  const std::array<Column*, kNumColumns> out = MutableColumns(columns);
  for (Column* column : out) column->Reserve(static_cast<int>(nodes.size()));
  Row previous = {};
  bool any_flag = false;
  for (const MapNode& node : nodes) {
    const Row row = ToRow(node, units);
    for (int c = 0; c < kNumColumns; ++c) out[c]->AddAlreadyReserved(row[c] - previous[c]);
    previous = row;
    any_flag = any_flag || Flags(node) != 0;
  }
  if (any_flag) {
    for (const MapNode& node : nodes) columns.add_flags(Flags(node));
  }
  return columns;
}

absl::StatusOr<std::vector<MapNode>> DecodeColumns(const v1::NodeColumns& columns,
                                                   const ColumnUnits& units) {
  RETURN_IF_ERROR(ValidateLengths(columns));
  const std::array<const Column*, kNumColumns> in = Columns(columns);
  std::vector<MapNode> nodes;
  nodes.reserve(columns.index_size());
  Row row = {};
  for (int i = 0; i < columns.index_size(); ++i) {
    for (int c = 0; c < kNumColumns; ++c) {
      if (__builtin_add_overflow(row[c], in[c]->Get(i), &row[c])) {
        return InvalidField(absl::StrCat(kColumnNames[c], "[", i, "]"), "the sum overflows");
      }
    }
    const uint32_t flags = columns.flags_size() == 0 ? 0 : columns.flags(i);
    absl::StatusOr<MapNode> node = FromRow(row, flags, units);
    if (!node.ok()) {
      return absl::InvalidArgumentError(absl::StrCat(node.status().message(), " (entry ", i, ")"));
    }
    nodes.push_back(*std::move(node));
  }
  return nodes;
}

MapNode Quantised(const MapNode& node, const ColumnUnits& units) {
  const Row row = ToRow(node, units);
  MapNode quantised = node;
  quantised.stamp.ns = row[1] * units.stamp_ns;
  quantised.map_from_body.translation = Eigen::Vector3d(row[2], row[3], row[4]) * units.position_m;
  quantised.map_from_body.rotation =
      ExpSO3(Eigen::Vector3d(row[5], row[6], row[7]) * units.rotation_rad);
  return quantised;
}

}  // namespace overtone
