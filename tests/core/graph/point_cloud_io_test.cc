// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/graph/point_cloud_io.h"

#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace overtone {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::string Path() {
  return testing::TempDir() + testing::UnitTest::GetInstance()->current_test_info()->name();
}

absl::StatusOr<PointCloud> Read(const std::string& bytes) {
  std::ofstream(Path(), std::ios::binary) << bytes;
  return ReadPointCloud(Path());
}

std::string Pcd(const std::string& fields, const std::string& size, const std::string& type,
                const std::string& points, const std::string& data) {
  return "# .PCD v0.7\nVERSION 0.7\nFIELDS " + fields + "\nSIZE " + size + "\nTYPE " + type +
         "\nWIDTH " + points + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + points + "\nDATA " +
         data;
}

template <typename... T>
std::string Packed(T... values) {
  std::string bytes;
  (bytes.append(reinterpret_cast<const char*>(&values), sizeof(values)), ...);
  return bytes;
}

TEST(ReadPointCloud, ReadsAnAsciiPcdAndLeavesOutWhatIsNotFinite) {
  const auto cloud = Read(Pcd("x y z", "4 4 4", "F F F", "3", "ascii\n1 2 3\nnan 0 0\n-4 5e1 .5"));
  ASSERT_TRUE(cloud.ok()) << cloud.status();
  EXPECT_THAT(cloud->points, ElementsAre(Eigen::Vector3f(1, 2, 3), Eigen::Vector3f(-4, 50, 0.5)));
  EXPECT_TRUE(cloud->intensities.empty());
}

TEST(ReadPointCloud, TakesFieldsInAnyOrderAndSkipsOthers) {
  const std::string header =
      "VERSION 0.7\nFIELDS z normal intensity y x\nSIZE 8 4 2 4 8\n"
      "TYPE F F U F F\nCOUNT 1 3 1 1 1\nWIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA binary\n";
  const auto cloud = Read(header + Packed(3.0, 0.f, 0.f, 1.f, uint16_t{300}, 2.f, 1.0) +
                          Packed(6.0, 0.f, 0.f, 1.f, uint16_t{7}, 5.f, 1e60));  // no float32
  ASSERT_TRUE(cloud.ok()) << cloud.status();
  EXPECT_THAT(cloud->points, ElementsAre(Eigen::Vector3f(1, 2, 3)));
  EXPECT_THAT(cloud->intensities, ElementsAre(255)) << "clamped, not wrapped";
}

TEST(ReadPointCloud, ScalesIntensitiesOnlyWhereTheyAreFractionsOfOne) {
  const auto intensities = [](const std::string& first, const std::string& second) {
    return Read(Pcd("x y z intensity", "4 4 4 4", "F F F F", "2",
                    "ascii\n0 0 0 " + first + "\n0 0 0 " + second))
        ->intensities;
  };
  EXPECT_THAT(intensities("0.5", "1"), ElementsAre(128, 255));
  EXPECT_THAT(intensities("0", "1"), ElementsAre(0, 1));
  EXPECT_THAT(intensities("0.6", "200.4"), ElementsAre(1, 200));
  EXPECT_THAT(intensities("-3", "nan"), ElementsAre(0, 0));
}

TEST(ReadPointCloud, ReadsPlyOfBothKinds) {
  const std::string properties =
      "element vertex 2\ncomment of anyone\nproperty uchar red\nproperty double x\n"
      "property float y\nproperty float z\nproperty short scalar_intensity\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const auto ascii =
      Read("ply\nformat ascii 1.0\n" + properties + "9 1 2 3 40\n9 4 5 6 -1\n3 0 1 0\n");
  ASSERT_TRUE(ascii.ok()) << ascii.status();
  const auto binary = Read("ply\r\nformat binary_little_endian 1.0\r\n" + properties +
                           Packed(uint8_t{9}, 1.0, 2.f, 3.f, int16_t{40}) +
                           Packed(uint8_t{9}, 4.0, 5.f, 6.f, int16_t{-1}) + "faces");
  ASSERT_TRUE(binary.ok()) << binary.status();
  for (const PointCloud& cloud : {*ascii, *binary}) {
    EXPECT_THAT(cloud.points, ElementsAre(Eigen::Vector3f(1, 2, 3), Eigen::Vector3f(4, 5, 6)));
    EXPECT_THAT(cloud.intensities, ElementsAre(40, 0));
  }
}

TEST(ReadPointCloud, ReadsMorePointsThanItTakesAtOnce) {
  std::string bytes = Pcd("x y z", "4 4 4", "F F F", "20000", "binary\n");
  for (int i = 0; i < 20000; ++i) bytes += Packed(float(i), 0.f, 0.f);
  const auto cloud = Read(bytes);
  ASSERT_TRUE(cloud.ok()) << cloud.status();
  ASSERT_EQ(cloud->size(), 20000u);
  for (int i = 0; i < 20000; ++i) ASSERT_EQ(cloud->points[i].x(), i);
}

TEST(ReadPointCloud, RefusesWhatContradictsItselfAndSaysWhy) {
  const auto what = [](const std::string& bytes) {
    const auto cloud = Read(bytes);
    EXPECT_FALSE(cloud.ok()) << bytes;
    EXPECT_THAT(cloud.status().message(), HasSubstr(Path() + ":"));
    return std::string(cloud.status().message());
  };
  const std::string xyz = Packed(1.f, 2.f, 3.f);
  const std::string trillion = "1000000000000";
  EXPECT_THAT(what(Pcd("x y z", "4 4 4", "F F F", trillion, "binary\n" + xyz)), HasSubstr("room"));
  EXPECT_THAT(what(Pcd("x y z", "4 4 4", "F F F", trillion, "ascii\n1 2 3")), HasSubstr("room"));
  EXPECT_THAT(what("ply\nformat ascii 1.0\nelement vertex " + trillion +
                   "\nproperty float x\nproperty float y\nproperty float z\nend_header\n1 2 3"),
              HasSubstr("room"));
  EXPECT_THAT(what(Pcd("x y z", "4 4 4", "F F F", "2", "binary\n" + xyz)), HasSubstr("room for 1"));
  EXPECT_THAT(what(Pcd("x y", "4 4", "F F", "1", "ascii\n1 2")), HasSubstr("x, y, z"));
  EXPECT_THAT(what(Pcd("x x y z", "4 4 4 4", "F F F F", "0", "ascii\n")), HasSubstr("more than"));
  EXPECT_THAT(what(Pcd("x y z", "4 4 4", "F I F", "0", "ascii\n")), HasSubstr("not a float"));
  EXPECT_THAT(what(Pcd("x y z", "4 4 2", "F F F", "0", "ascii\n")), HasSubstr("2 bytes"));
  EXPECT_THAT(what(Pcd("x y z", "4 4 3", "F F F", "0", "ascii\n")), HasSubstr("SIZE"));
  EXPECT_THAT(what(Pcd("x y z", "4 4", "F F F", "0", "ascii\n")), HasSubstr("entries"));
  EXPECT_THAT(what(Pcd("x y z", "4 4 4", "F F F", "-1", "ascii\n")), HasSubstr("-1"));
  EXPECT_THAT(what(Pcd("x y z", "4 4 4", "F F F", "1", "ascii\n1.25 2.5")), HasSubstr("2 numbers"));
  EXPECT_THAT(what(Pcd("x y z", "4 4 4", "F F F", "1", "ascii\n1 2 wall")), HasSubstr("wall"));
  EXPECT_THAT(what(Pcd("x y z", "4 4 4", "F F F", "2", "ascii\n1 2 3     \n")),
              HasSubstr("ends after 1 of 2"));
  EXPECT_THAT(what(Pcd("x y z", "4 4 4", "F F F", "1", "binary_compressed\n" + xyz)),
              HasSubstr("binary_compressed"));
  EXPECT_THAT(what("VERSION 0.7\nFIELDS x y z\nWIDTH 4294967296\nHEIGHT 4294967296\nPOINTS 0\n"
                   "DATA ascii\n"),
              HasSubstr("WIDTH x HEIGHT"))
      << "a product of 2^64";
  EXPECT_THAT(what("FIELDS x y z\nCOUNT 1 1 99999999999\n"), HasSubstr("COUNT"));
  EXPECT_THAT(what("FIELDS x y z\nDATA ascii\n"), HasSubstr("POINTS"));
  EXPECT_THAT(what("FIELDS x y z\n"), HasSubstr("without DATA"));
  EXPECT_THAT(what(std::string(10000, 'F')), HasSubstr("longer"));
  EXPECT_THAT(what("ply\nformat binary_big_endian 1.0\n"), HasSubstr("big_endian"));
  EXPECT_THAT(what("ply\nformat ascii 1.0\nelement face 1\n"), HasSubstr("not vertex"));
  EXPECT_THAT(what("ply\nformat ascii 1.0\nelement vertex 1\nproperty list uchar int x\n"),
              HasSubstr("type"));
  EXPECT_THAT(what("ply\nelement vertex 1\nend_header\n"), HasSubstr("no format"));
  EXPECT_THAT(what("ply\nformat ascii 1.0\nend_header\n"), HasSubstr("no element"));
  what("");
  what(std::string("\0\0\0", 3));
}

TEST(ReadPointCloud, EveryCutOfAFileIsRefusedOrShorter) {
  const std::string whole = Pcd("x y z intensity", "4 4 4 4", "F F F F", "2", "binary\n") +
                            Packed(1.f, 2.f, 3.f, 4.f, 5.f, 6.f, 7.f, 8.f);
  ASSERT_TRUE(Read(whole).ok());
  for (size_t length = 0; length < whole.size(); ++length) {
    EXPECT_FALSE(Read(whole.substr(0, length)).ok()) << length;
  }
}

TEST(ReadPointCloud, NamesAFileThatIsNotThereAndADirectory) {
  for (const std::string& path : {Path() + "/none", std::string(testing::TempDir())}) {
    const auto cloud = ReadPointCloud(path);
    EXPECT_EQ(cloud.status().code(), absl::StatusCode::kNotFound);
    EXPECT_THAT(cloud.status().message(), HasSubstr(path + ": "));
  }
}

TEST(WritePcd, IsReadBackAsItWas) {
  PointCloud cloud;
  cloud.points = {{1, 2, 3}, {-0.1f, 1e-30f, 3e38f}};
  for (const std::vector<uint8_t>& intensities :
       {std::vector<uint8_t>{}, {0, 1}, {1, 1}, {7, 255}}) {
    cloud.intensities = intensities;
    ASSERT_TRUE(WritePcd(Path(), cloud).ok());
    const auto read = ReadPointCloud(Path());
    ASSERT_TRUE(read.ok()) << read.status();
    EXPECT_EQ(read->points, cloud.points);
    EXPECT_EQ(read->intensities, cloud.intensities);
  }
  ASSERT_TRUE(WritePcd(Path(), {}).ok());
  EXPECT_TRUE(ReadPointCloud(Path())->empty());
}

TEST(WritePcd, SaysWhenItCannotWrite) {
  EXPECT_EQ(WritePcd(Path() + "/no/folder.pcd", {}).code(), absl::StatusCode::kUnavailable);
  PointCloud cloud;
  cloud.points.assign(10000, Eigen::Vector3f::Zero());
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
  EXPECT_EQ(WritePcd("/dev/full", cloud).code(), absl::StatusCode::kUnavailable);
}

}  // namespace
}  // namespace overtone
