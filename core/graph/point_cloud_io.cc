// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/graph/point_cloud_io.h"

#include <filesystem>
#include <fstream>
#include <system_error>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/line_reader.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/graph/point_records.h"

namespace overtone {

absl::StatusOr<PointCloud> ReadPointCloud(const std::string& path) {
  std::error_code error;
  const auto bytes = std::filesystem::file_size(path, error);  // an error for what is no file
  std::ifstream file(path, std::ios::binary);
  if (error || !file) return absl::NotFoundError(absl::StrCat(path, ": cannot be opened"));
  const bool ply = file.peek() == 'p';  // a PCD begins with # or VERSION
  LineReader lines(file, path);
  ASSIGN_OR_RETURN(const PointRecordLayout layout,
                   ply ? ReadPlyHeader(lines) : ReadPcdHeader(lines));
  const int64_t header_bytes = file.eof() ? bytes : static_cast<int64_t>(file.tellg());
  return ReadPointRecords(file, lines, layout, static_cast<int64_t>(bytes) - header_bytes);
}

absl::Status WritePcd(const std::string& path, const PointCloud& cloud) {
  const bool intensity = !cloud.intensities.empty();
  std::ofstream out(path, std::ios::binary);
  out << "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n"
      << (intensity ? "FIELDS x y z intensity\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1\n"
                    : "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n")
      << "WIDTH " << cloud.size() << "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " << cloud.size()
      << "\nDATA binary\n";
  for (size_t i = 0; i < cloud.size(); ++i) {
    const float record[] = {cloud.points[i].x(), cloud.points[i].y(), cloud.points[i].z(),
                            intensity ? cloud.intensities[i] : 0.f};
    out.write(reinterpret_cast<const char*>(record), intensity ? 16 : 12);
  }
  out.flush();
  if (!out) return absl::UnavailableError(absl::StrCat(path, ": cannot be written"));
  return absl::OkStatus();
}

}  // namespace overtone
