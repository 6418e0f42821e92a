// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/geometry/trajectory_io.h"

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "gtest/gtest.h"
#include "overtone/tests/core/geometry/random_poses.h"

namespace overtone {
namespace {

constexpr TrajectoryFormat kTum = TrajectoryFormat::kTum;
constexpr TrajectoryFormat kEuroc = TrajectoryFormat::kEuroc;
constexpr TrajectoryFormat kKitti = TrajectoryFormat::kKitti;

absl::StatusOr<Trajectory> Parse(const std::string& text, TrajectoryFormat format) {
  std::istringstream in(text);
  return ReadTrajectory(in, "file", format);
}

std::string TempPath(const std::string& name) {
  return testing::TempDir() + "/trajectory_io_" + name;
}

void ExpectPose(const Rigid3d& pose, const Eigen::Vector3d& position, const Eigen::Vector4d& xyzw) {
  EXPECT_LT((pose.translation - position).norm(), 1e-15);
  EXPECT_LT((pose.rotation.coeffs() - xyzw).norm(), 1e-15);
}

TEST(ReadTrajectory, ReadsTumRows) {
  const auto trajectory = Parse(
      "# timestamp(s) tx ty tz qx qy qz qw\n"
      "1403636580.83856 1 -2 3 0.6 0 0 0.8\n"
      "\n"
      "1.403636580843560219e+09\t4 5 6   0 0.6 0 -0.8\r\n",
      kTum);
  ASSERT_TRUE(trajectory.ok()) << trajectory.status();
  ASSERT_EQ(trajectory->size(), 2u);
  EXPECT_EQ((*trajectory)[0].stamp.ns, 1403636580838560000);
  EXPECT_EQ((*trajectory)[1].stamp.ns, 1403636580843560219);
  ExpectPose((*trajectory)[0].pose, {1, -2, 3}, {0.6, 0, 0, 0.8});
  ExpectPose((*trajectory)[1].pose, {4, 5, 6}, {0, 0.6, 0, -0.8});
}

TEST(ReadTrajectory, ReadsEurocRowsWithWFirstAndFurtherColumns) {
  const auto trajectory = Parse(
      "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], "
      "q_RS_z [], v_RS_R_x\n"
      "1403636580838555648,1,-2,3,0.8,0.6,0,0,0.1\n"
      "1403636580838555649, 4, 5, 6, -0.8, 0, 0.6, 0, 0.1\n",
      kEuroc);
  ASSERT_TRUE(trajectory.ok()) << trajectory.status();
  EXPECT_EQ((*trajectory)[0].stamp.ns, 1403636580838555648);
  EXPECT_EQ((*trajectory)[1].stamp.ns, 1403636580838555649);
  ExpectPose((*trajectory)[0].pose, {1, -2, 3}, {0.6, 0, 0, 0.8});
  ExpectPose((*trajectory)[1].pose, {4, 5, 6}, {0, 0.6, 0, -0.8});
}

TEST(ReadTrajectory, ReadsKittiRowsAtTenHertz) {
  // A quarter turn about z: x of the sensor points along y.
  const auto trajectory = Parse("1 0 0 0 0 1 0 0 -0 0 1 0\n0 -1 0 7 1 0 0 8 0 0 1 9\n", kKitti);
  ASSERT_TRUE(trajectory.ok()) << trajectory.status();
  EXPECT_EQ((*trajectory)[0].stamp.ns, 0);
  EXPECT_EQ((*trajectory)[1].stamp.ns, 100000000);
  const Rigid3d& pose = (*trajectory)[1].pose;
  EXPECT_LT((pose * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(7, 9, 9)).norm(), 1e-14);
}

TEST(ReadTrajectory, SpacesKittiRowsByTheRateAskedFor) {
  std::istringstream in(
      "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 0 0 0 1 0\n1 0 0 2 0 1 0 0 0 0 1 0\n");
  const auto trajectory = ReadTrajectory(in, "file", kKitti, 3);
  ASSERT_TRUE(trajectory.ok()) << trajectory.status();
  EXPECT_EQ((*trajectory)[1].stamp.ns, 333333333);
  EXPECT_EQ((*trajectory)[2].stamp.ns, 666666667);
}

TEST(ReadTrajectory, RefusesARateThatIsNone) {
  for (const double rate : {0.0, -10.0, 1e-9, 1e10, std::nan("")}) {
    std::istringstream in("1 0 0 0 0 1 0 0 0 0 1 0\n");
    const absl::Status status = ReadTrajectory(in, "file", kKitti, rate).status();
    EXPECT_EQ(status.message().find("row_rate_hz: "), 0u) << status;
  }
}

TEST(ReadTrajectory, NormalisesQuaternionsWithinAThousandth) {
  for (const std::string w : {"0.9991", "1.0009", "-1.0009"}) {
    const auto trajectory = Parse("1 0 0 0 0 0 0 " + w + "\n", kTum);
    ASSERT_TRUE(trajectory.ok()) << trajectory.status();
    EXPECT_NEAR(trajectory->front().pose.rotation.norm(), 1, 1e-15);
  }
}

TEST(ReadTrajectory, BringsRoundedMatricesToTheNearestRotation) {
  // Six digits, as MulRan has: off by 1e-6.
  const auto trajectory = Parse(
      "0.999999 -0.00117698 0.000161588 -3.38661e-05 0.00117693 0.999999 0.000303866 5.4763e-06 "
      "-0.000161945 "
      "-0.000303675 1 4.55694e-05\n",
      kKitti);
  ASSERT_TRUE(trajectory.ok()) << trajectory.status();
  const Eigen::Quaterniond& rotation = trajectory->front().pose.rotation;
  EXPECT_NEAR(rotation.norm(), 1, 1e-15);
  EXPECT_NEAR(LogSO3(rotation).z(), 0.00117696, 1e-8);
}

struct BadInput {
  std::string why;
  TrajectoryFormat format;
  std::string text;
  std::string message;  // how the error begins
};

TEST(ReadTrajectory, RefusesBadInputAndNamesTheLine) {
  const std::string tum = "1 0 0 0 0 0 0 1\n";
  const std::string euroc = "1000,0,0,0,1,0,0,0,9\n";
  const std::string kitti = "1 0 0 0 0 1 0 0 0 0 1 0\n";
  const std::vector<BadInput> cases = {
      {"nothing", kTum, "", "file: no poses"},
      {"only comments", kEuroc, "# a\n#b\n\n", "file: no poses"},
      {"truncated row", kTum, tum + "2 0 0 0 0 0", "file:2: 6 fields where 8"},
      {"too many fields", kTum, "1 0 0 0 0 0 0 1 0\n", "file:1: 9 fields where 8"},
      {"other separator", kTum, "1,0,0,0,0,0,0,1\n", "file:1: 1 fields where 8"},
      {"a word", kTum, "# c\n\n1 0 0 zero 0 0 0 1\n", "file:3: 'zero' is not a number"},
      {"NaN position", kTum, "1 nan 0 0 0 0 0 1\n", "file:1: 'nan' is not a finite number"},
      {"infinite position", kTum, "1 0 -inf 0 0 0 0 1\n", "file:1: '-inf' is not a finite number"},
      {"overflowing position", kTum, "1 0 1e999 0 0 0 0 1\n", "file:1: '1e999' is not a finite"},
      {"huge position", kTum, "1 0 0 2e7 0 0 0 1\n", "file:1: position (0, 0, 2e+07)"},
      {"NaN quaternion", kTum, "1 0 0 0 nan 0 0 1\n", "file:1: 'nan'"},
      {"zero quaternion", kTum, "1 0 0 0 0 0 0 0\n", "file:1: quaternion has length 0"},
      {"long quaternion", kTum, "1 0 0 0 0 0 0 1.0011\n", "file:1: quaternion has length 1.0011"},
      {"short quaternion", kTum, "1 0 0 0 0 0 0 0.9989\n", "file:1: quaternion has length 0.9989"},
      {"overflowing quaternion", kTum, "1 0 0 0 1e200 1e200 0 0\n",
       "file:1: quaternion has length"},
      {"NaN stamp", kTum, "nan 0 0 0 0 0 0 1\n", "file:1: 'nan' is not a time"},
      {"infinite stamp", kTum, "inf 0 0 0 0 0 0 1\n", "file:1: 'inf' is not a time"},
      {"stamp beyond int64", kTum, "1e300 0 0 0 0 0 0 1\n", "file:1: '1e300' is not a time"},
      {"nanoseconds as seconds", kTum, "1403636580838555648 0 0 0 0 0 0 1\n",
       "file:1: '14036365808"},
      {"time going backwards", kTum, "2 0 0 0 0 0 0 1\n" + tum, "file:2: time does not increase"},
      {"time standing still", kTum, tum + tum, "file:2: time does not increase"},
      {"binary", kTum, std::string("\x7f\x45\x4c\x46\0\0\n\xff\xfe", 9), "file:1: 1 fields"},
      {"zero bytes", kTum, std::string("1 0 0 0 0 0 0 1\0\n", 17), "file:1: '1\\000' is not"},

      {"truncated row", kEuroc, euroc + "2000,0,0,0,1,0,0", "file:2: 7 fields where 9"},
      {"row shorter than the first", kEuroc, euroc + "2000,0,0,0,1,0,0,0",
       "file:2: 8 fields where 9"},
      {"too few columns", kEuroc, "1000,0,0,0,1,0,0\n", "file:1: 7 fields where 8"},
      {"seconds", kEuroc, "1403636580.83,0,0,0,1,0,0,0\n", "file:1: the stamp is not an integer"},
      {"scientific stamp", kEuroc, "1.4e18,0,0,0,1,0,0,0\n", "file:1: the stamp is not an integer"},
      {"stamp beyond int64", kEuroc, "9223372036854775808,0,0,0,1,0,0,0\n", "file:1: the stamp"},
      {"empty field", kEuroc, "1000,,0,0,1,0,0,0\n", "file:1: '' is not a number"},
      {"bad quaternion", kEuroc, "1000,0,0,0,1,1,0,0\n", "file:1: quaternion has length"},
      {"NaN", kEuroc, "1000,0,0,NaN,1,0,0,0\n", "file:1: 'NaN' is not a finite number"},
      {"time standing still", kEuroc, euroc + euroc, "file:2: time does not increase"},

      {"truncated row", kKitti, kitti + "1 0 0 0 0 1 0 0 0 0 1", "file:2: 11 fields where 12"},
      {"too many fields", kKitti, "1 0 0 0 0 1 0 0 0 0 1 0 0\n", "file:1: 13 fields where 12"},
      {"NaN", kKitti, "1 0 0 0 0 1 0 0 0 nan 1 0\n", "file:1: 'nan' is not a finite number"},
      {"infinite", kKitti, "1 0 0 inf 0 1 0 0 0 0 1 0\n", "file:1: 'inf' is not a finite number"},
      {"mirror", kKitti, "-1 0 0 0 0 1 0 0 0 0 1 0\n", "file:1: the left 3 x 3 block"},
      {"scaled", kKitti, "2 0 0 0 0 2 0 0 0 0 2 0\n", "file:1: the left 3 x 3 block"},
      {"sheared", kKitti, "1 0.01 0 0 0 1 0 0 0 0 1 0\n", "file:1: the left 3 x 3 block"},
      {"zero", kKitti, "0 0 0 0 0 0 0 0 0 0 0 0\n", "file:1: the left 3 x 3 block"},
      {"overflowing", kKitti, "1e300 0 0 0 0 1 0 0 0 0 1 0\n", "file:1: the left 3 x 3 block"},
      {"huge position", kKitti, "1 0 0 0 0 1 0 -1e8 0 0 1 0\n", "file:1: position (0, -1e+08, 0)"},
  };
  for (const BadInput& bad : cases) {
    const absl::Status status = Parse(bad.text, bad.format).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << bad.why;
    EXPECT_EQ(status.message().find(bad.message), 0u) << bad.why << ": " << status;
  }
}

TEST(ReadTrajectory, RefusesAHundredMegabytesWithoutANewline) {
  const std::string path = TempPath("garbage");
  {
    std::ofstream file(path, std::ios::binary);
    const std::string megabyte(1 << 20, '7');
    for (int i = 0; i < 100; ++i) file << megabyte;
  }
  for (const TrajectoryFormat format : {kTum, kEuroc, kKitti}) {
    const absl::Status status = ReadTrajectory(path, format).status();
    EXPECT_EQ(status.message(), path + ":1: longer than 4096 characters");
  }
  std::filesystem::remove(path);
}

TEST(ReadTrajectory, SaysWhenThereIsNoSuchFile) {
  EXPECT_EQ(ReadTrajectory("/nonexistent", kTum).status().code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(ReadTrajectory("/", kTum).status().code(), absl::StatusCode::kDataLoss);
}

Trajectory SomeTrajectory() {
  RandomPoses random(1);
  Trajectory trajectory;
  for (int i = 0; i < 50; ++i) {
    trajectory.push_back({{1763776251123456789 + 100000007LL * i}, random.Pose(50)});
  }
  return trajectory;
}

TEST(WriteTrajectory, ReadsBackToTheNanosecondAndTheLastBit) {
  const Trajectory written = SomeTrajectory();
  for (const TrajectoryFormat format : {kTum, kEuroc}) {
    const std::string path = TempPath("round_trip");
    ASSERT_TRUE(WriteTrajectory(path, format, written).ok());
    const auto read = ReadTrajectory(path, format);
    ASSERT_TRUE(read.ok()) << read.status();
    ASSERT_EQ(read->size(), written.size());
    for (size_t i = 0; i < written.size(); ++i) {
      EXPECT_EQ((*read)[i].stamp, written[i].stamp);
      EXPECT_EQ((*read)[i].pose.translation, written[i].pose.translation);
      ExpectPose((*read)[i].pose, written[i].pose.translation, written[i].pose.rotation.coeffs());
    }
    std::filesystem::remove(path);
  }
}

TEST(WriteTrajectory, KittiKeepsPosesAndDropsStamps) {
  const Trajectory written = SomeTrajectory();
  std::stringstream text;
  WriteTrajectory(text, kKitti, written);
  const auto read = ReadTrajectory(text, "file", kKitti);
  ASSERT_TRUE(read.ok()) << read.status();
  ASSERT_EQ(read->size(), written.size());
  for (size_t i = 0; i < written.size(); ++i) {
    EXPECT_LT(((*read)[i].pose.ToMatrix() - written[i].pose.ToMatrix()).norm(), 1e-14);
  }
}

TEST(WriteTrajectory, SaysWhenItCannotWrite) {
  EXPECT_EQ(WriteTrajectory("/nonexistent/file", kTum, {}).code(), absl::StatusCode::kUnavailable);
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  EXPECT_EQ(WriteTrajectory("/dev/full", kTum, SomeTrajectory()).code(),
            absl::StatusCode::kUnavailable);
}

}  // namespace
}  // namespace overtone
