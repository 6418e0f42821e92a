// SPDX-License-Identifier: Apache-2.0
// Log and Exp against the pairs of poses in golden/se3_log/pairs.csv (origin:
// tests/data/README.md).
#include <array>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include "absl/strings/str_split.h"
#include "gtest/gtest.h"
#include "overtone/core/common/line_reader.h"
#include "overtone/core/common/parse_number.h"
#include "overtone/core/geometry/se3.h"

namespace overtone {
namespace {

// a (x y z qw qx qy qz), b (likewise), xi = Log(a^-1 b) (rho phi); further columns are not read
// here.
using Row = std::array<double, 20>;

std::vector<Row> ReadRows(const std::string& path) {
  std::ifstream file(path);
  LineReader reader(file, path);
  std::vector<Row> rows;
  absl::string_view line;
  while (reader.Next(&line)) {
    const std::vector<absl::string_view> fields = absl::StrSplit(line, ',');
    Row row;
    if (fields.size() < row.size() || fields[0] == "a_x") continue;
    const auto numbers = absl::MakeConstSpan(fields).first(row.size());
    const absl::Status status = ParseFiniteDoubles(numbers, absl::MakeSpan(row));
    EXPECT_TRUE(status.ok()) << reader.Error(status.message());
    rows.push_back(row);
  }
  return rows;
}

Rigid3d PoseAt(const double* v) {
  return Rigid3d(Eigen::Quaterniond(v[3], v[4], v[5], v[6]), Eigen::Vector3d(v[0], v[1], v[2]));
}

void ExpectLogsToMatch(const std::vector<Row>& rows) {
  double worst = 0;
  for (const Row& row : rows) {
    const Rigid3d a_from_b = PoseAt(&row[0]).Inverse() * PoseAt(&row[7]);
    const Vector6d expected = Eigen::Map<const Vector6d>(&row[14]);
    const double error = (Log(a_from_b) - expected).norm() / (1 + expected.norm());
    EXPECT_LT(error, 1e-13) << "xi = " << expected.transpose();
    EXPECT_LT((Exp(expected).ToMatrix() - a_from_b.ToMatrix()).cwiseAbs().maxCoeff(), 1e-12);
    worst = std::max(worst, error);
  }
  std::printf("%zu pairs, largest relative error of Log %.1e\n", rows.size(), worst);
}

TEST(Se3Golden, CommittedPairsMatch) {
  const auto rows = ReadRows(OVERTONE_SOURCE_DIR "/tests/data/golden/se3_log/pairs.csv");
  ASSERT_EQ(rows.size(), 50u);
  ExpectLogsToMatch(rows);
}

TEST(Se3Golden, AllPairsMatch) {
  const char* named = std::getenv("OVERTONE_TEST_GOLDEN_DIR");
  const std::string folder = named != nullptr ? named : OVERTONE_SOURCE_DIR "/../shared/golden";
  const auto rows = ReadRows(folder + "/se3_log/pairs.csv");
  if (rows.empty())
    GTEST_SKIP() << folder << "/se3_log is not there (see OVERTONE_TEST_GOLDEN_DIR)";
  ExpectLogsToMatch(rows);
}

}  // namespace
}  // namespace overtone
