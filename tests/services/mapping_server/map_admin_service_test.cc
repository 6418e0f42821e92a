// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <functional>
#include <map>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

#include "absl/time/clock.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/core/geometry/trajectory_io.h"
#include "overtone/core/graph/g2o_io.h"
#include "overtone/proto/conversion/geometry_conversion.h"
#include "overtone/tests/services/mapping_server/server_fixture.h"

namespace overtone {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::MakeClosure;
using testing::MakeSubmap;
using testing::ServerTest;
using ::testing::StartsWith;
using testing::Uploader;

const MissionId kAnna = {"anna", "run1"};
const MissionId kBert = {"bert", "run1"};

class MapAdminServiceTest : public ServerTest {
 protected:
  grpc::Status Export(const v1::ExportMapRequest& request, std::string& file) {
    grpc::ClientContext context;
    context.set_deadline(testing::Deadline());
    auto stream = admin_->ExportMap(&context, request);
    v1::ExportMapResponse response;
    while (stream->Read(&response)) {
      EXPECT_LE(response.chunk().size(), 256u << 10);
      file += response.chunk();
    }
    return stream->Finish();
  }
  std::string Export(v1::ExportFormat format) {
    v1::ExportMapRequest request;
    request.set_map("mine");
    request.set_format(format);
    std::string file;
    const grpc::Status status = Export(request, file);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return file;
  }

  // Anna with a closure within, Bert apart.
  void MakeMap() {
    Uploader uploader(*mapping_, "mine", kAnna);
    uploader.Read();
    ASSERT_TRUE(uploader.Send(MakeSubmap(0, 0, 10)).has_ack());
    Submap closing = MakeSubmap(1, 10, 10);
    LoopClosure closure = MakeClosure({kAnna, 15}, {kAnna, 3});
    closure.from_tform_to = closing.keyframes[5].mission_from_body.Inverse() *
                            MakeSubmap(0, 0, 10).keyframes[3].mission_from_body;
    closing.loop_closures.push_back(closure);
    // Waits for an end that never comes.
    closing.loop_closures.push_back(MakeClosure({kAnna, 12}, {{"carl", "run1"}, 3}));
    ASSERT_TRUE(uploader.Send(closing).has_ack());
    uploader.Close();
    Upload("mine", kBert, 1, 7);
    WaitForNodes("mine", 27);
  }
};

TEST_F(MapAdminServiceTest, MapsAreListedPageByPage) {
  for (const char* map : {"c", "a", "b", "a-b"}) Upload(map, kAnna, 1, 3);
  v1::ListMapsRequest request;
  request.set_page_size(3);
  auto response = Call<v1::ListMapsResponse>(&v1::MapAdminService::Stub::ListMaps, request);
  std::vector<std::string> names;
  for (const auto& map : response.maps()) names.push_back(map.map());
  EXPECT_THAT(names, ElementsAre("a", "a-b", "b"));
  Upload("aa", kAnna, 1, 3);  // behind us: neither repeated nor skipped
  request.set_page_token(response.next_page_token());
  response = Call<v1::ListMapsResponse>(&v1::MapAdminService::Stub::ListMaps, request);
  ASSERT_EQ(response.maps_size(), 1);
  EXPECT_EQ(response.maps(0).map(), "c");
  EXPECT_EQ(response.next_page_token(), "");
}

TEST_F(MapAdminServiceTest, ASummaryCountsWhatTheMapHolds) {
  MakeMap();
  const auto response =
      Call<v1::ListMapsResponse>(&v1::MapAdminService::Stub::ListMaps, v1::ListMapsRequest());
  ASSERT_EQ(response.maps_size(), 1);
  const v1::MapSummary& map = response.maps(0);
  EXPECT_EQ(map.missions(), 2);
  EXPECT_EQ(map.keyframes(), 27);
  EXPECT_EQ(map.loop_closures(), 2);
  EXPECT_EQ(map.components(), 2);
  EXPECT_GT(map.revision(), 0u);
  EXPECT_GT(map.published().seconds(), 1'600'000'000);
}

TEST_F(MapAdminServiceTest, RobotsAndMissionsAreCounted) {
  MakeMap();
  Upload("mine", {"anna", "run0"}, 1, 4);
  Uploader open(*mapping_, "mine", kBert);
  open.Read();
  v1::ListRobotsRequest robots_request;
  robots_request.set_map("mine");
  // The server lets go of a stream just after the robot has seen its end.
  v1::ListRobotsResponse robots;
  const absl::Time deadline = absl::Now() + absl::Seconds(20);
  do {
    robots = Call<v1::ListRobotsResponse>(&v1::MapAdminService::Stub::ListRobots, robots_request);
    ASSERT_EQ(robots.robots_size(), 2);
  } while (robots.robots(0).uploading() && absl::Now() < deadline);
  EXPECT_EQ(robots.robots(0).robot(), "anna");
  EXPECT_EQ(robots.robots(0).missions(), 2);
  EXPECT_EQ(robots.robots(0).keyframes(), 24);
  EXPECT_FALSE(robots.robots(0).uploading());
  EXPECT_TRUE(robots.robots(1).uploading());

  WaitForNodes("mine", 31);
  v1::ListMissionsRequest request;
  request.set_map("mine");
  request.set_robot("anna");
  request.set_page_size(1);
  auto missions = Call<v1::ListMissionsResponse>(&v1::MapAdminService::Stub::ListMissions, request);
  ASSERT_EQ(missions.missions_size(), 1);
  EXPECT_EQ(missions.missions(0).id().mission(), "run0");
  request.set_page_token(missions.next_page_token());
  missions = Call<v1::ListMissionsResponse>(&v1::MapAdminService::Stub::ListMissions, request);
  ASSERT_EQ(missions.missions_size(), 1);
  const v1::Mission& mission = missions.missions(0);
  EXPECT_EQ(mission.id().mission(), "run1");
  EXPECT_TRUE(mission.anchored());
  EXPECT_EQ(mission.submaps(), 2);
  EXPECT_EQ(mission.keyframes(), 20);
  EXPECT_EQ(mission.last_stamp_ns() - mission.first_stamp_ns(), 19 * testing::kStampStepNs);
  EXPECT_NEAR(mission.path_m(), 19 * 0.5, 0.01);
  EXPECT_EQ(missions.next_page_token(), "");
}

TEST_F(MapAdminServiceTest, LoopClosuresAreListedWithTheirVerdict) {
  MakeMap();
  v1::ListLoopClosuresRequest request;
  request.set_map("mine");
  const auto list = [&] {
    return Call<v1::ListLoopClosuresResponse>(&v1::MapAdminService::Stub::ListLoopClosures,
                                              request);
  };
  auto response = list();
  ASSERT_EQ(response.loop_closures_size(), 2);
  EXPECT_EQ(response.loop_closures(0).verdict(), v1::LOOP_CLOSURE_VERDICT_ACCEPTED);
  EXPECT_EQ(response.loop_closures(1).verdict(), v1::LOOP_CLOSURE_VERDICT_PENDING);
  request.set_verdict(v1::LOOP_CLOSURE_VERDICT_PENDING);
  response = list();
  ASSERT_EQ(response.loop_closures_size(), 1);
  EXPECT_EQ(response.loop_closures(0).loop_closure().to().mission().robot(), "carl");
  request.set_robot("bert");
  EXPECT_EQ(list().loop_closures_size(), 0);
}

TEST_F(MapAdminServiceTest, ATrajectoryHoldsEveryKeyframe) {
  MakeMap();
  v1::GetTrajectoryRequest request;
  request.set_map("mine");
  *request.mutable_mission() = ToProto(kAnna);
  const auto response =
      Call<v1::GetTrajectoryResponse>(&v1::MapAdminService::Stub::GetTrajectory, request);
  ASSERT_EQ(response.nodes_size(), 20);
  EXPECT_TRUE(response.anchored());
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(response.nodes(i).index(), i);
    EXPECT_EQ(response.nodes(i).stamp_ns(), 1'000'000'000 + i * testing::kStampStepNs);
    EXPECT_EQ(response.nodes(i).submap_start(), i % 10 == 0);
  }
}

TEST_F(MapAdminServiceTest, TheTumFileHasARowForEveryKeyframe) {
  MakeMap();
  std::istringstream file(Export(v1::EXPORT_FORMAT_TUM));
  std::vector<std::string> comments;
  int rows = 0;
  for (std::string line; std::getline(file, line);) {
    if (line[0] == '#') {
      comments.push_back(line);
      continue;
    }
    std::istringstream fields(line);
    double value = 0;
    int count = 0;
    while (fields >> value) ++count;
    EXPECT_EQ(count, 8) << line;
    ++rows;
  }
  EXPECT_EQ(rows, 27);
  EXPECT_THAT(comments, ElementsAre("# anna/run1, component 0, anchored", HasSubstr("x y z"),
                                    "# bert/run1, component 1, unanchored", HasSubstr("x y z")));
}

TEST_F(MapAdminServiceTest, TheG2oFileReadsBackAsThePoseGraphWithoutPendingClosures) {
  MakeMap();
  std::istringstream file(Export(v1::EXPORT_FORMAT_G2O));
  const auto graph = ReadG2o(file, "export");
  ASSERT_TRUE(graph.ok()) << graph.status();
  EXPECT_EQ(graph->graph.poses.size(), 27u);
  EXPECT_EQ(graph->graph.edges.size(), 19u + 6u + 1u);
  EXPECT_TRUE(
      graph->graph.edges[0].information.isApprox(testing::FullCovariance().inverse(), 1e-6));
}

TEST_F(MapAdminServiceTest, TrajectoriesOfEveryFormatReadBackAsTheOptimisedPoses) {
  MakeMap();
  v1::GetTrajectoryRequest request;
  request.set_map("mine");
  *request.mutable_mission() = ToProto(kAnna);
  const auto anna =
      Call<v1::GetTrajectoryResponse>(&v1::MapAdminService::Stub::GetTrajectory, request);
  for (const auto& [format, file_format] : std::map<v1::ExportFormat, TrajectoryFormat>{
           {v1::EXPORT_FORMAT_TUM, TrajectoryFormat::kTum},
           {v1::EXPORT_FORMAT_EUROC, TrajectoryFormat::kEuroc},
           {v1::EXPORT_FORMAT_KITTI, TrajectoryFormat::kKitti}}) {
    v1::ExportMapRequest one;
    one.set_map("mine");
    one.set_format(format);
    *one.mutable_mission() = ToProto(kAnna);
    std::string text;
    ASSERT_TRUE(Export(one, text).ok());
    EXPECT_THAT(text, StartsWith("# anna/run1, component 0, anchored\n"));
    EXPECT_THAT(text, ::testing::Not(HasSubstr("bert")));
    std::istringstream file(text);
    const auto trajectory = ReadTrajectory(file, "export", file_format);
    ASSERT_TRUE(trajectory.ok()) << trajectory.status();
    ASSERT_EQ(trajectory->size(), 20u);
    for (int i = 0; i < 20; ++i) {
      const auto pose = FromProto(anna.nodes(i).map_tform_body());
      ASSERT_TRUE(pose.ok());
      EXPECT_LT((pose->translation - (*trajectory)[i].pose.translation).norm(), 1e-9);
      EXPECT_LT(pose->rotation.angularDistance((*trajectory)[i].pose.rotation), 1e-7);
      if (file_format == TrajectoryFormat::kKitti) continue;  // has no stamps
      EXPECT_EQ((*trajectory)[i].stamp.ns, anna.nodes(i).stamp_ns());
    }
    // Of the whole map: every mission, one after the other.
    const std::string all = Export(format);
    EXPECT_THAT(all, StartsWith(text));
    EXPECT_THAT(all, HasSubstr("\n# bert/run1, component 1, unanchored\n"));
  }
}

TEST_F(MapAdminServiceTest, TheG2oFileOfAMissionHoldsItsOwnEdgesOnly) {
  MakeMap();
  for (const auto& [mission, poses, edges] :
       {std::tuple(kAnna, 20u, 19u + 1u), std::tuple(kBert, 7u, 6u)}) {
    v1::ExportMapRequest request;
    request.set_map("mine");
    request.set_format(v1::EXPORT_FORMAT_G2O);
    *request.mutable_mission() = ToProto(mission);
    std::string text;
    ASSERT_TRUE(Export(request, text).ok());
    std::istringstream file(text);
    const auto graph = ReadG2o(file, "export");
    ASSERT_TRUE(graph.ok()) << graph.status();
    EXPECT_EQ(graph->graph.poses.size(), poses);
    EXPECT_EQ(graph->graph.edges.size(), edges);
  }
}

TEST_F(MapAdminServiceTest, OdometryComesWithTheTrajectoryAsItWasUploaded) {
  Submap submap = MakeSubmap(0, 0, 20);
  LoopClosure closure = MakeClosure({kAnna, 15}, {kAnna, 3});
  closure.from_tform_to =
      submap.keyframes[15].mission_from_body.Inverse() * submap.keyframes[3].mission_from_body;
  closure.from_tform_to.translation.x() += 0.1;  // bends the map
  submap.loop_closures = {closure};
  Uploader uploader(*mapping_, "mine", kAnna);
  uploader.Read();
  ASSERT_TRUE(uploader.Send(submap).has_ack());
  uploader.Close();
  Settle("mine");
  v1::GetTrajectoryRequest request;
  request.set_map("mine");
  *request.mutable_mission() = ToProto(kAnna);
  const auto trajectory = [&] {
    return Call<v1::GetTrajectoryResponse>(&v1::MapAdminService::Stub::GetTrajectory, request);
  };
  EXPECT_EQ(trajectory().odometry_size(), 0);
  request.set_odometry(true);
  const auto response = trajectory();
  ASSERT_EQ(response.nodes_size(), 20);
  ASSERT_EQ(response.odometry_size(), 20);
  double largest_move_m = 0;
  for (int i = 0; i < 20; ++i) {
    const auto odometry = FromProto(response.odometry(i));
    const auto optimised = FromProto(response.nodes(i).map_tform_body());
    ASSERT_TRUE(odometry.ok() && optimised.ok());
    const Eigen::Vector3d& uploaded = submap.keyframes[i].mission_from_body.translation;
    EXPECT_LT((odometry->translation - uploaded).norm(), 1e-12);
    largest_move_m = std::max(largest_move_m, (optimised->translation - uploaded).norm());
  }
  EXPECT_GT(largest_move_m, 1e-3);
}

TEST_F(MapAdminServiceTest, ALargeExportComesInChunksThatAddUp) {
  Upload("mine", kAnna, 20, 250);
  v1::ListMapsResponse maps;
  WaitForNodes("mine", 2000);
  do {
    maps = Call<v1::ListMapsResponse>(&v1::MapAdminService::Stub::ListMaps, v1::ListMapsRequest());
  } while (maps.maps(0).keyframes() < 5000);
  const std::string file = Export(v1::EXPORT_FORMAT_TUM);
  EXPECT_GT(file.size(), 256u << 10);
  EXPECT_EQ(std::count(file.begin(), file.end(), '\n'), 5000 + 2);  // two lines of comment
}

TEST_F(MapAdminServiceTest, EveryBadRequestIsRefusedByField) {
  MakeMap();
  using Stub = v1::MapAdminService::Stub;
  using grpc::StatusCode;
  struct Case {
    std::string message;
    StatusCode code;
    std::function<grpc::Status()> call;
  };
  const auto maps = [this](int page_size, const std::string& token) {
    v1::ListMapsRequest request;
    request.set_page_size(page_size);
    request.set_page_token(token);
    v1::ListMapsResponse response;
    return Try(&Stub::ListMaps, request, response);
  };
  const auto robots = [this](const std::string& map, int page_size) {
    v1::ListRobotsRequest request;
    request.set_map(map);
    request.set_page_size(page_size);
    v1::ListRobotsResponse response;
    return Try(&Stub::ListRobots, request, response);
  };
  const auto missions = [this](const std::string& map, const std::string& robot) {
    v1::ListMissionsRequest request;
    request.set_map(map);
    request.set_robot(robot);
    v1::ListMissionsResponse response;
    return Try(&Stub::ListMissions, request, response);
  };
  const auto closures = [this](const std::string& map, int verdict, const std::string& robot) {
    v1::ListLoopClosuresRequest request;
    request.set_map(map);
    request.set_verdict(static_cast<v1::LoopClosureVerdict>(verdict));
    request.set_robot(robot);
    v1::ListLoopClosuresResponse response;
    return Try(&Stub::ListLoopClosures, request, response);
  };
  const auto trajectory = [this](const std::string& map, const MissionId& mission) {
    v1::GetTrajectoryRequest request;
    request.set_map(map);
    *request.mutable_mission() = ToProto(mission);
    v1::GetTrajectoryResponse response;
    return Try(&Stub::GetTrajectory, request, response);
  };
  const auto file = [this](const std::string& map, int format) {
    v1::ExportMapRequest request;
    request.set_map(map);
    request.set_format(static_cast<v1::ExportFormat>(format));
    std::string ignored;
    return Export(request, ignored);
  };
  const auto mission_file = [this](const MissionId& mission) {
    v1::ExportMapRequest request;
    request.set_map("mine");
    request.set_format(v1::EXPORT_FORMAT_EUROC);
    *request.mutable_mission() = ToProto(mission);
    std::string ignored;
    return Export(request, ignored);
  };
  const std::vector<Case> cases = {
      {"page_size:", StatusCode::INVALID_ARGUMENT, [&] { return maps(-1, ""); }},
      {"page_size:", StatusCode::INVALID_ARGUMENT, [&] { return maps(1001, ""); }},
      {"page_token:", StatusCode::INVALID_ARGUMENT, [&] { return maps(10, "\x01garbage"); }},
      {"map:", StatusCode::INVALID_ARGUMENT, [&] { return robots("", 0); }},
      {"map:", StatusCode::NOT_FOUND, [&] { return robots("nowhere", 0); }},
      {"page_size:", StatusCode::INVALID_ARGUMENT, [&] { return robots("mine", INT32_MIN); }},
      {"map:", StatusCode::INVALID_ARGUMENT, [&] { return missions("Mine", ""); }},
      {"robot:", StatusCode::INVALID_ARGUMENT, [&] { return missions("mine", "a/b"); }},
      {"map:", StatusCode::NOT_FOUND, [&] { return closures("nowhere", 0, ""); }},
      {"verdict:", StatusCode::INVALID_ARGUMENT, [&] { return closures("mine", 99, ""); }},
      {"robot:", StatusCode::INVALID_ARGUMENT, [&] { return closures("mine", 0, " "); }},
      {"map:", StatusCode::NOT_FOUND, [&] { return trajectory("nowhere", kAnna); }},
      {"mission.robot:", StatusCode::INVALID_ARGUMENT, [&] { return trajectory("mine", {}); }},
      {"mission:", StatusCode::NOT_FOUND,
       [&] {
         return trajectory("mine", {"carl", "run1"});
       }},
      {"map:", StatusCode::NOT_FOUND, [&] { return file("nowhere", v1::EXPORT_FORMAT_TUM); }},
      {"format:", StatusCode::INVALID_ARGUMENT, [&] { return file("mine", 0); }},
      {"format:", StatusCode::INVALID_ARGUMENT, [&] { return file("mine", 42); }},
      {"mission.robot:", StatusCode::INVALID_ARGUMENT, [&] { return mission_file({}); }},
      {"mission:", StatusCode::NOT_FOUND,
       [&] {
         return mission_file({"carl", "run1"});
       }},
  };
  for (const Case& bad : cases) {
    const grpc::Status status = bad.call();
    EXPECT_EQ(status.error_code(), bad.code) << bad.message << " " << status.error_message();
    EXPECT_THAT(status.error_message(), StartsWith(bad.message));
  }
  EXPECT_TRUE(maps(0, "").ok());
}

}  // namespace
}  // namespace overtone
