// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/cloud_library.h"

#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "gtest/gtest.h"
#include "overtone/core/graph/point_cloud_codec.h"
#include "overtone/tests/services/mapping_server/blob_shelf.h"

namespace overtone {
namespace {

const MissionId kAnna = {"anna", "run"};
constexpr int kKeyframes = 6;

// A metre apart along x, all with announced clouds but the last.
Submap StraightOn() {
  Submap submap;
  for (int i = 0; i < kKeyframes; ++i) {
    Keyframe keyframe;
    keyframe.stamp = {i + 1};
    keyframe.mission_from_body.translation.x() = i;
    submap.keyframes.push_back(keyframe);
    if (i < kKeyframes - 1) submap.clouds.push_back({i, nullptr, std::string(32, 'c'), 100});
  }
  return submap;
}

std::shared_ptr<const std::string> Encoded(const PointCloud& cloud) {
  return std::make_shared<const std::string>(*EncodePointCloud(cloud, {}));
}

// One point, dead ahead.
std::shared_ptr<const std::string> Ahead(float range_m) {
  PointCloud cloud;
  cloud.points = {{range_m, 0, 0}};
  return Encoded(cloud);
}

std::shared_ptr<const std::string> AllAround(int points) {
  PointCloud cloud;
  for (int i = 0; i < points; ++i) {
    const double heading = 2 * M_PI * i / points;
    cloud.points.emplace_back(9 * std::cos(heading), 9 * std::sin(heading), 0);
  }
  return Encoded(cloud);
}

class CloudLibraryTest : public ::testing::Test {
 protected:
  CloudLibraryTest()
      : library_(/*gather_length_m=*/2, /*max_views=*/2,
                 [this](const std::string& sha256) { return blobs_.Get(sha256); }) {
    library_.AddSubmap(kAnna, StraightOn());
  }

  int NumPoints(int64_t index) {
    const auto view = library_.View({kAnna, index});
    EXPECT_TRUE(view.ok()) << view.status();
    return view.ok() ? static_cast<int>((*view)->cloud->points.size()) : -1;
  }

  void AddCloud(const NodeId& node, std::shared_ptr<const std::string> blob) {
    library_.AddCloud(node, blobs_.Put(std::move(blob)));
  }

  BlobShelf blobs_;
  CloudLibrary library_;
};

TEST_F(CloudLibraryTest, ALimitedViewGathersTheKeyframesBehindIt) {
  for (int i = 0; i < 5; ++i) {
    if (i != 3) AddCloud({kAnna, i}, Ahead(10));
  }
  const auto view = library_.View({kAnna, 4});
  ASSERT_TRUE(view.ok()) << view.status();
  EXPECT_EQ((*view)->node, (NodeId{kAnna, 4}));
  EXPECT_DOUBLE_EQ((*view)->travelled_m, 4);
  // Of keyframes 2 and 4: 1 is further back than 2 m, and 3 has none.
  ASSERT_EQ((*view)->cloud->points.size(), 2u);
  float sum_m = 0;
  for (const Eigen::Vector3f& point : (*view)->cloud->points) sum_m += point.x();
  EXPECT_NEAR(sum_m, 10 + 8, 0.02);  // in the body frame of keyframe 4
}

TEST_F(CloudLibraryTest, AViewAllAroundStandsForItself) {
  AddCloud({kAnna, 0}, AllAround(200));
  AddCloud({kAnna, 1}, AllAround(100));
  EXPECT_EQ(NumPoints(1), 100);
  AddCloud({kAnna, 2}, Ahead(10));
  EXPECT_EQ(NumPoints(2), 301);
}

TEST_F(CloudLibraryTest, TheWayGoesOnFromSubmapToSubmap) {
  Submap next = StraightOn();
  next.first_index = kKeyframes;
  next.clouds.clear();
  for (Keyframe& keyframe : next.keyframes) keyframe.mission_from_body.translation.x() += 6;
  library_.AddSubmap(kAnna, next);
  AddCloud({kAnna, 5}, Ahead(10));
  AddCloud({kAnna, 7}, Ahead(10));
  const auto view = library_.View({kAnna, 7});
  ASSERT_TRUE(view.ok()) << view.status();
  EXPECT_DOUBLE_EQ((*view)->travelled_m, 7);
  EXPECT_EQ((*view)->cloud->points.size(), 2u);
}

TEST_F(CloudLibraryTest, WhatIsNotThereIsNotFound) {
  AddCloud({kAnna, 1}, Ahead(10));
  AddCloud({kAnna, 77}, Ahead(10));
  AddCloud({{"bert", "run"}, 0}, Ahead(10));
  for (const NodeId& node :
       {NodeId{kAnna, 2}, NodeId{kAnna, 77}, NodeId{kAnna, -1}, NodeId{{"bert", "run"}, 0}}) {
    EXPECT_EQ(library_.View(node).status().code(), absl::StatusCode::kNotFound) << ToString(node);
  }
}

TEST_F(CloudLibraryTest, ABlobThatIsNoCloudIsRefused) {
  AddCloud({kAnna, 1}, std::make_shared<const std::string>("no cloud"));
  EXPECT_EQ(library_.View({kAnna, 1}).status().code(), absl::StatusCode::kInvalidArgument);
  // Its neighbours do without it.
  AddCloud({kAnna, 0}, Ahead(10));
  AddCloud({kAnna, 2}, Ahead(10));
  EXPECT_EQ(NumPoints(2), 2);
}

TEST_F(CloudLibraryTest, CloudsStayWhereTheyAreStored) {
  AddCloud({kAnna, 0}, AllAround(100));
  AddCloud({kAnna, 1}, AllAround(100));
  ASSERT_EQ(NumPoints(0), 100);
  blobs_.Clear();
  EXPECT_EQ(NumPoints(0), 100);  // the view is kept
  EXPECT_EQ(library_.View({kAnna, 1}).status().code(), absl::StatusCode::kNotFound);
}

TEST_F(CloudLibraryTest, TheViewsAskedForLastAreKept) {
  for (int i = 0; i < 3; ++i) AddCloud({kAnna, i}, AllAround(100));
  const auto first = *library_.View({kAnna, 0});
  EXPECT_EQ(*library_.View({kAnna, 0}), first);
  ASSERT_TRUE(library_.View({kAnna, 1}).ok());
  EXPECT_EQ(*library_.View({kAnna, 0}), first);
  ASSERT_TRUE(library_.View({kAnna, 1}).ok());
  ASSERT_TRUE(library_.View({kAnna, 2}).ok());
  EXPECT_NE(*library_.View({kAnna, 0}), first);  // made again
}

TEST_F(CloudLibraryTest, CloudsAreAnnouncedThereOrGone) {
  const NodeId announced = {kAnna, 1}, silent = {kAnna, 5};
  EXPECT_TRUE(library_.ExpectsCloud(announced));
  EXPECT_FALSE(library_.HasCloud(announced));
  EXPECT_FALSE(library_.ExpectsCloud(silent));
  EXPECT_FALSE(library_.ExpectsCloud({{"bert", "run"}, 0}));
  library_.CloudGone(announced);
  library_.CloudGone({kAnna, 77});
  EXPECT_FALSE(library_.ExpectsCloud(announced));
  AddCloud(announced, Ahead(10));  // another mission had the same
  EXPECT_TRUE(library_.HasCloud(announced));
  EXPECT_TRUE(library_.ExpectsCloud(announced));
}

}  // namespace
}  // namespace overtone
