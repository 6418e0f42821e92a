// SPDX-License-Identifier: Apache-2.0
// What operators see of loop closures, and what they say to them, over the wire.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/tests/core/place_recognition/synthetic_place.h"
#include "overtone/tests/services/mapping_server/cloud_fixture.h"
#include "overtone/tests/services/mapping_server/server_fixture.h"

namespace overtone {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::MakeClosure;
using testing::MakeSubmap;
using testing::MakeSubmapWithClouds;
using testing::ServerTest;
using ::testing::StartsWith;
using testing::TestOptions;
using testing::Uploader;
using testing::Watcher;
using testing::WatchRequest;
using Stub = v1::MapAdminService::Stub;

const MissionId kAnna = {"anna", "run1"};
const MissionId kBert = {"bert", "run1"};
const MissionId kCarl = {"carl", "run1"};

const char kRight[] = "anna/run1:15>anna/run1:3#0";
const char kWrong[] = "anna/run1:18>anna/run1:0#0";  // by metres
const char kPending[] = "anna/run1:12>carl/run1:3#0";
const char kLikely[] = "anna/run1:10>anna/run1:9#0";    // scored, 0.9
const char kUnlikely[] = "anna/run1:16>anna/run1:1#0";  // scored, 0.3

class ClosureAdminTest : public ServerTest {
 protected:
  // Anna with all of the above, Bert apart.
  void MakeMap() {
    Submap submap = MakeSubmap(0, 0, 20);
    LoopClosure right = MakeClosure({kAnna, 15}, {kAnna, 3});
    right.from_tform_to =
        submap.keyframes[15].mission_from_body.Inverse() * submap.keyframes[3].mission_from_body;
    submap.loop_closures = {right, MakeClosure({kAnna, 18}, {kAnna, 0}),
                            MakeClosure({kAnna, 12}, {kCarl, 3})};
    submap.candidates = {{{kAnna, 10}, {kAnna, 9}, 0.9}, {{kAnna, 16}, {kAnna, 1}, 0.3}};
    Uploader uploader(*mapping_, "mine", kAnna);
    ASSERT_TRUE(uploader.Read().has_ready());
    ASSERT_TRUE(uploader.Send(submap).has_ack());
    EXPECT_TRUE(uploader.Close().ok());
    Upload("mine", kBert, 1, 7);
    Settle("mine");
  }

  // A mission whose first keyframe has a cloud.
  void UploadCloud(const MissionId& mission, const std::string& blob) {
    Uploader uploader(*mapping_, "mine", mission);
    ASSERT_TRUE(uploader.Read().has_ready());
    ASSERT_TRUE(uploader.Send(MakeSubmapWithClouds(0, 0, 5, {blob})).has_ack());
    ASSERT_TRUE(uploader.Read().has_want());
    v1::BlobChunk chunk;
    chunk.set_sha256(Sha256(blob));
    chunk.set_data(blob);
    uploader.Write(chunk);
    EXPECT_EQ(uploader.Read().blob_result().code(), 0);
    EXPECT_TRUE(uploader.Close().ok());
    Settle("mine");
  }

  std::vector<v1::LoopClosureStatus> List(v1::ListLoopClosuresRequest request = {}) {
    request.set_map("mine");
    const auto response = Call<v1::ListLoopClosuresResponse>(&Stub::ListLoopClosures, request);
    return {response.loop_closures().begin(), response.loop_closures().end()};
  }
  static std::vector<std::string> Ids(const std::vector<v1::LoopClosureStatus>& closures) {
    std::vector<std::string> ids;
    for (const v1::LoopClosureStatus& closure : closures) ids.push_back(closure.id());
    return ids;
  }
  v1::LoopClosureStatus Closure(const std::string& id) {
    for (const v1::LoopClosureStatus& closure : List()) {
      if (closure.id() == id) return closure;
    }
    ADD_FAILURE() << "no " << id;
    return {};
  }

  v1::ExplainLoopClosuresResponse Explain(const NodeId& node, double radius_m) {
    v1::ExplainLoopClosuresRequest request;
    request.set_map("mine");
    *request.mutable_node() = ToProto(node);
    request.set_radius_m(radius_m);
    return Call<v1::ExplainLoopClosuresResponse>(&Stub::ExplainLoopClosures, request);
  }

  template <typename Response, typename Request, typename Method>
  grpc::Status TryDecide(Method method, const std::string& map, const std::string& id) {
    Request request;
    request.set_map(map);
    request.set_id(id);
    Response response;
    return Try(method, request, response);
  }
  grpc::Status Veto(const std::string& map, const std::string& id) {
    return TryDecide<v1::VetoLoopClosureResponse, v1::VetoLoopClosureRequest>(
        &Stub::VetoLoopClosure, map, id);
  }
  grpc::Status Force(const std::string& map, const std::string& id) {
    return TryDecide<v1::ForceLoopClosureResponse, v1::ForceLoopClosureRequest>(
        &Stub::ForceLoopClosure, map, id);
  }
  grpc::Status RollBack(const std::string& map, uint64_t revision,
                        v1::RollBackResponse* response = nullptr) {
    v1::RollBackRequest request;
    request.set_map(map);
    request.set_revision(revision);
    v1::RollBackResponse ignored;
    return Try(&Stub::RollBack, request, response == nullptr ? ignored : *response);
  }
  std::vector<v1::Revision> Revisions() {
    v1::ListRevisionsRequest request;
    request.set_map("mine");
    const auto response = Call<v1::ListRevisionsResponse>(&Stub::ListRevisions, request);
    return {response.revisions().begin(), response.revisions().end()};
  }
  double LastX() {
    v1::GetTrajectoryRequest request;
    request.set_map("mine");
    *request.mutable_mission() = ToProto(kAnna);
    const auto response = Call<v1::GetTrajectoryResponse>(&Stub::GetTrajectory, request);
    return response.nodes(response.nodes_size() - 1).map_tform_body().position().x();
  }
};

TEST_F(ClosureAdminTest, EveryCandidateIsListedWithItsFiguresAndWhy) {
  MakeMap();
  EXPECT_THAT(Ids(List()), ElementsAre(kRight, kWrong, kPending, kLikely, kUnlikely));
  const v1::LoopClosureStatus right = Closure(kRight);
  EXPECT_EQ(right.verdict(), v1::LOOP_CLOSURE_VERDICT_ACCEPTED);
  EXPECT_EQ(right.proposer(), v1::LOOP_CLOSURE_PROPOSER_ROBOT);
  EXPECT_GT(right.weight(), 0.9);
  EXPECT_LT(right.chi_square(), 1);
  EXPECT_TRUE(right.measured());
  EXPECT_FALSE(right.has_registration());
  EXPECT_EQ(right.score(), 0);
  EXPECT_GE(right.since_revision(), 1u);
  EXPECT_EQ(right.loop_closure().from().index(), 15);
  EXPECT_THAT(right.reason(), StartsWith("fits the map"));

  const v1::LoopClosureStatus wrong = Closure(kWrong);
  EXPECT_EQ(wrong.verdict(), v1::LOOP_CLOSURE_VERDICT_REJECTED_INCONSISTENT);
  EXPECT_EQ(wrong.weight(), 0);
  EXPECT_THAT(wrong.reason(), StartsWith("further from its mission's odometry"));

  EXPECT_EQ(Closure(kPending).verdict(), v1::LOOP_CLOSURE_VERDICT_PENDING);
  const v1::LoopClosureStatus likely = Closure(kLikely);
  EXPECT_EQ(likely.verdict(), v1::LOOP_CLOSURE_VERDICT_ACCEPTED);
  EXPECT_EQ(likely.proposer(), v1::LOOP_CLOSURE_PROPOSER_ROBOT_SCORE);
  EXPECT_EQ(likely.score(), 0.9);
  EXPECT_EQ(likely.score_threshold(), 0.5);
  const v1::LoopClosureStatus unlikely = Closure(kUnlikely);
  EXPECT_EQ(unlikely.verdict(), v1::LOOP_CLOSURE_VERDICT_REJECTED_SCORE);
  EXPECT_EQ(unlikely.reason(), "similarity 0.30 is below 0.50");
}

TEST_F(ClosureAdminTest, EachFilterKeepsItsOwn) {
  MakeMap();
  const auto ids = [&](const std::function<void(v1::ListLoopClosuresRequest&)>& narrow) {
    v1::ListLoopClosuresRequest request;
    narrow(request);
    return Ids(List(request));
  };
  using Request = v1::ListLoopClosuresRequest;
  EXPECT_THAT(ids([](Request& r) { r.set_robot("carl"); }), ElementsAre(kPending));
  EXPECT_THAT(ids([](Request& r) { r.set_robot("bert"); }), IsEmpty());
  EXPECT_THAT(ids([](Request& r) { *r.mutable_mission() = ToProto(kCarl); }),
              ElementsAre(kPending));
  EXPECT_THAT(ids([](Request& r) {
                r.set_robot("anna");
                *r.mutable_mission() = ToProto(MissionId{"anna", "run2"});
              }),
              IsEmpty());
  EXPECT_THAT(ids([](Request& r) { r.set_verdict(v1::LOOP_CLOSURE_VERDICT_ACCEPTED); }),
              ElementsAre(kRight, kLikely));
  EXPECT_THAT(ids([](Request& r) { r.set_proposer(v1::LOOP_CLOSURE_PROPOSER_ROBOT_SCORE); }),
              ElementsAre(kLikely, kUnlikely));
  EXPECT_THAT(ids([](Request& r) { r.set_proposer(v1::LOOP_CLOSURE_PROPOSER_SCAN_CONTEXT); }),
              IsEmpty());
  EXPECT_THAT(ids([](Request& r) {
                r.set_verdict(v1::LOOP_CLOSURE_VERDICT_ACCEPTED);
                r.set_proposer(v1::LOOP_CLOSURE_PROPOSER_ROBOT);
              }),
              ElementsAre(kRight));
}

TEST_F(ClosureAdminTest, PagesOfAFilteredListAddUp) {
  MakeMap();
  v1::ListLoopClosuresRequest request;
  request.set_map("mine");
  request.set_robot("anna");
  request.set_page_size(2);
  std::vector<std::string> ids;
  std::vector<int> sizes;
  do {
    const auto response = Call<v1::ListLoopClosuresResponse>(&Stub::ListLoopClosures, request);
    sizes.push_back(response.loop_closures_size());
    for (const auto& closure : response.loop_closures()) ids.push_back(closure.id());
    request.set_page_token(response.next_page_token());
  } while (!request.page_token().empty() && sizes.size() < 9);
  EXPECT_THAT(sizes, ElementsAre(2, 2, 1));
  EXPECT_THAT(ids, ElementsAre(kRight, kWrong, kPending, kLikely, kUnlikely));
}

TEST_F(ClosureAdminTest, APlaceIsExplainedByTheCandidateThatCameFurthest) {
  MakeMap();
  // Keyframes are 0.5 m apart.
  const auto used = Explain({kAnna, 15}, 0.6);
  EXPECT_THAT(used.explanation(),
              AllOf(HasSubstr("There is 1 loop closure in use within 0.6 m of anna/run1:15"),
                    HasSubstr("anna/run1:15 and anna/run1:3: it fits the map")));
  ASSERT_EQ(used.candidates_size(), 2);
  EXPECT_EQ(used.candidates(0).id(), kRight);
  EXPECT_EQ(used.candidates(1).id(), kUnlikely);

  const auto rejected = Explain({kAnna, 16}, 0.2);
  EXPECT_THAT(rejected.explanation(),
              AllOf(HasSubstr("There is no loop within 0.2 m of anna/run1:16: of 1 proposed"),
                    HasSubstr("rejected_score: similarity 0.30 is below 0.50")));
  EXPECT_THAT(Explain({kAnna, 18}, 0.2).explanation(), HasSubstr("rejected_inconsistent"));
  EXPECT_THAT(Explain({kAnna, 12}, 2).explanation(), HasSubstr("There are 2 loop closures in use"));
  EXPECT_EQ(Explain({kAnna, 19}, 4).candidates_size(), 4);
  EXPECT_EQ(Explain({kAnna, 19}, 0).candidates_size(), 5);  // 5 m
}

TEST_F(ClosureAdminTest, APlaceWithoutCloudsIsExplainedToo) {
  MakeMap();
  const auto response = Explain({kBert, 3}, 0);
  EXPECT_EQ(response.explanation(),
            "There is no loop within 5 m of bert/run1:3 because nothing was proposed: no cloud of "
            "this keyframe was looked at, or there is no other place to compare it with.");
  EXPECT_EQ(response.candidates_size(), 0);
  EXPECT_FALSE(response.has_nearest());
}

TEST_F(ClosureAdminTest, APlaceThatLooksLikeNoOtherIsToldTheNearestOne) {
  ServerOptions options = TestOptions();
  options.loop_closures.proposer.min_similarity = 0.99;
  StartServer(options);
  UploadCloud(kAnna, *EncodePointCloud(SyntheticPlace(1), {}));
  UploadCloud(kBert, *EncodePointCloud(SyntheticPlace(2), {}));
  const auto response = Explain({kBert, 0}, 0);
  EXPECT_THAT(response.explanation(),
              AllOf(HasSubstr("because nothing was proposed"),
                    HasSubstr("looks most like it is anna/run1:0, with similarity 0."),
                    HasSubstr("; 0.99 are needed")));
  EXPECT_EQ(response.nearest().mission().robot(), "anna");
  EXPECT_EQ(response.nearest().index(), 0);
  EXPECT_GT(response.nearest_score(), 0);
  EXPECT_LT(response.nearest_score(), 0.99);
  EXPECT_EQ(response.score_threshold(), 0.99);
}

TEST_F(ClosureAdminTest, APlaceThatCannotBeComparedWithTheOneItLooksLikeSaysSo) {
  ServerOptions options = TestOptions();
  options.loop_closures.proposer.min_similarity = 0.1;
  StartServer(options);
  const PointCloud few = SyntheticPlace(1, 0, 0.1);  // for a registration
  UploadCloud(kAnna, *EncodePointCloud(few, {0.01}));
  UploadCloud(kBert, *EncodePointCloud(few, {0.02}));
  EXPECT_THAT(Explain({kBert, 0}, 0).explanation(),
              AllOf(HasSubstr("looks most like it is anna/run1:0"), HasSubstr("cannot be")));
}

// The robot cannot send the cloud that would measure the pair.
TEST_F(ClosureAdminTest, AScoredPairWaitsForItsCloudsUntilOneIsGone) {
  Submap submap = MakeSubmapWithClouds(0, 0, 12, {"a", "b"});
  submap.candidates = {{{kAnna, 0}, {kAnna, 1}, 0.9}};
  Uploader uploader(*mapping_, "mine", kAnna);
  ASSERT_TRUE(uploader.Read().has_ready());
  ASSERT_TRUE(uploader.Send(submap).has_ack());
  ASSERT_TRUE(uploader.Read().has_want());
  Settle("mine");
  EXPECT_THAT(List(), IsEmpty());
  v1::BlobChunk gone;
  gone.set_sha256(Sha256("b"));
  gone.set_gone(true);
  uploader.Write(gone);
  EXPECT_TRUE(uploader.Read().has_blob_result());
  Settle("mine");
  EXPECT_THAT(Ids(List()), ElementsAre("anna/run1:0>anna/run1:1#0"));
}

TEST_F(ClosureAdminTest, AForcedClosureBendsTheMapAndAVetoBendsItBack) {
  MakeMap();
  const double before_x = LastX();
  const uint64_t revision = Settle("mine").revision();
  ASSERT_TRUE(Force("mine", kWrong).ok());
  EXPECT_EQ(Settle("mine").revision(), revision + 1);
  EXPECT_EQ(Closure(kWrong).verdict(), v1::LOOP_CLOSURE_VERDICT_FORCED_BY_OPERATOR);
  EXPECT_EQ(Closure(kWrong).weight(), 1);
  EXPECT_GT(std::abs(LastX() - before_x), 1);

  ASSERT_TRUE(Veto("mine", kWrong).ok());
  EXPECT_EQ(Settle("mine").revision(), revision + 2);
  EXPECT_EQ(Closure(kWrong).verdict(), v1::LOOP_CLOSURE_VERDICT_VETOED_BY_OPERATOR);
  EXPECT_EQ(Closure(kWrong).weight(), 0);
  EXPECT_EQ(Closure(kRight).verdict(), v1::LOOP_CLOSURE_VERDICT_ACCEPTED);
  EXPECT_NEAR(LastX(), before_x, 1e-3);
}

TEST_F(ClosureAdminTest, RevisionsTellNewestFirstWhatTheyChanged) {
  MakeMap();
  ASSERT_TRUE(Force("mine", kWrong).ok());
  Settle("mine");
  ASSERT_TRUE(Veto("mine", kWrong).ok());
  const v1::MapSummary map = Settle("mine");
  const std::vector<v1::Revision> revisions = Revisions();
  ASSERT_EQ(revisions.size(), map.revision());
  for (size_t i = 0; i < revisions.size(); ++i) {
    EXPECT_EQ(revisions[i].revision(), revisions.size() - i);
    EXPECT_EQ(revisions[i].map_epoch(), map.map_epoch());
  }
  // As long as the wrong one had to be used, the right one contradicted the map.
  EXPECT_THAT(revisions[1].accepted(), ElementsAre(kWrong));
  EXPECT_THAT(revisions[1].dropped(), ElementsAre(kRight));
  EXPECT_THAT(revisions[0].accepted(), ElementsAre(kRight));
  EXPECT_THAT(revisions[0].dropped(), ElementsAre(kWrong));
  EXPECT_GT(revisions[1].largest_move_m(), 1);
  EXPECT_GT(revisions[0].largest_move_m(), revisions[0].mean_move_m());
  EXPECT_EQ(revisions[0].keyframes(), 27);
  EXPECT_EQ(revisions[0].missions(), 2);
  EXPECT_EQ(revisions[0].anchored_missions(), 1);
  EXPECT_EQ(revisions[0].components(), 2);
  EXPECT_GE(revisions[0].published().seconds(), revisions[1].published().seconds());
  int64_t counted = 0;
  for (const v1::VerdictCount& count : revisions[0].verdicts()) counted += count.count();
  EXPECT_EQ(counted, 5);

  v1::ListRevisionsRequest request;
  request.set_map("mine");
  request.set_page_size(1);
  std::vector<uint64_t> paged;
  do {
    const auto response = Call<v1::ListRevisionsResponse>(&Stub::ListRevisions, request);
    ASSERT_EQ(response.revisions_size(), 1);
    paged.push_back(response.revisions(0).revision());
    request.set_page_token(response.next_page_token());
  } while (!request.page_token().empty());
  EXPECT_EQ(paged.size(), revisions.size());
  EXPECT_TRUE(std::is_sorted(paged.rbegin(), paged.rend()));
}

TEST_F(ClosureAdminTest, ARollBackStartsANewEpochWithASnapshotForEveryWatcher) {
  MakeMap();
  const double before_x = LastX();
  const v1::MapSummary before = Settle("mine");
  ASSERT_TRUE(Force("mine", kWrong).ok());
  Settle("mine");
  Watcher watcher(*mapping_, WatchRequest("mine"));
  v1::WatchGraphResponse frame = watcher.ReadGraph();
  ASSERT_TRUE(frame.has_snapshot());
  EXPECT_EQ(frame.snapshot().map_epoch(), before.map_epoch());

  v1::RollBackResponse answer;
  ASSERT_TRUE(RollBack("mine", before.revision(), &answer).ok());
  EXPECT_EQ(answer.vetoed(), 1);
  EXPECT_GT(answer.map_epoch(), before.map_epoch());
  uint64_t epoch = 0;
  do {
    frame = watcher.ReadGraph();
    epoch = frame.has_delta() ? frame.delta().changes().map_epoch() : frame.snapshot().map_epoch();
  } while (epoch == before.map_epoch());
  EXPECT_EQ(epoch, answer.map_epoch());
  ASSERT_TRUE(frame.has_snapshot()) << frame.ShortDebugString();
  EXPECT_EQ(Settle("mine").map_epoch(), answer.map_epoch());
  EXPECT_EQ(Closure(kWrong).verdict(), v1::LOOP_CLOSURE_VERDICT_VETOED_BY_OPERATOR);
  EXPECT_NEAR(LastX(), before_x, 1e-3);
  EXPECT_EQ(Revisions()[0].map_epoch(), answer.map_epoch());
  EXPECT_EQ(Revisions()[1].map_epoch(), before.map_epoch());

  // Within the new epoch deltas go on.
  ASSERT_TRUE(Force("mine", kWrong).ok());
  frame = watcher.ReadGraph();
  ASSERT_TRUE(frame.has_delta()) << frame.ShortDebugString();
  EXPECT_EQ(frame.delta().changes().map_epoch(), answer.map_epoch());
  // Revisions of the old epoch are no way back any more.
  const grpc::Status status = RollBack("mine", before.revision());
  EXPECT_EQ(status.error_code(), grpc::StatusCode::NOT_FOUND) << status.error_message();
}

TEST_F(ClosureAdminTest, EveryBadRequestIsRefusedByField) {
  MakeMap();
  using grpc::StatusCode;
  struct Case {
    std::string message;
    StatusCode code;
    std::function<grpc::Status()> call;
  };
  const auto list = [this](const std::function<void(v1::ListLoopClosuresRequest&)>& spoil) {
    v1::ListLoopClosuresRequest request;
    request.set_map("mine");
    spoil(request);
    v1::ListLoopClosuresResponse response;
    return Try(&Stub::ListLoopClosures, request, response);
  };
  const auto explain = [this](const std::string& map, const NodeId& node, double radius_m) {
    v1::ExplainLoopClosuresRequest request;
    request.set_map(map);
    *request.mutable_node() = ToProto(node);
    request.set_radius_m(radius_m);
    v1::ExplainLoopClosuresResponse response;
    return Try(&Stub::ExplainLoopClosures, request, response);
  };
  const auto revisions = [this](const std::string& map, int page_size, const std::string& token) {
    v1::ListRevisionsRequest request;
    request.set_map(map);
    request.set_page_size(page_size);
    request.set_page_token(token);
    v1::ListRevisionsResponse response;
    return Try(&Stub::ListRevisions, request, response);
  };
  const auto bad_proposer = [](auto& r) {
    r.set_proposer(static_cast<v1::LoopClosureProposer>(99));
  };
  const auto bad_mission = [](auto& r) { r.mutable_mission()->set_robot("Anna"); };
  const NodeId anna0 = {kAnna, 0};
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  constexpr auto kInvalid = StatusCode::INVALID_ARGUMENT;
  constexpr auto kNotFound = StatusCode::NOT_FOUND;
  const std::vector<Case> cases = {
      {"proposer:", kInvalid, [&] { return list(bad_proposer); }},
      {"mission.robot:", kInvalid, [&] { return list(bad_mission); }},
      {"page_size:", kInvalid, [&] { return list([](auto& r) { r.set_page_size(1001); }); }},
      {"map:", kNotFound, [&] { return explain("nowhere", anna0, 0); }},
      {"map:", kInvalid, [&] { return explain("", anna0, 0); }},
      {"node.mission.robot:", kInvalid,
       [&] {
         return explain("mine", {{"", "run1"}, 0}, 0);
       }},
      {"node.index:", kInvalid,
       [&] {
         return explain("mine", {kAnna, -1}, 0);
       }},
      {"node: anna/run1 has keyframes 0 to 19", kNotFound,
       [&] {
         return explain("mine", {kAnna, 20}, 0);
       }},
      {"node: no mission carl/run1", kNotFound,
       [&] {
         return explain("mine", {kCarl, 0}, 0);
       }},
      {"radius_m:", kInvalid, [&] { return explain("mine", anna0, -1); }},
      {"radius_m:", kInvalid, [&] { return explain("mine", anna0, nan); }},
      {"radius_m:", kInvalid, [&] { return explain("mine", anna0, infinity); }},
      {"map:", kNotFound, [&] { return revisions("nowhere", 0, ""); }},
      {"page_size:", kInvalid, [&] { return revisions("mine", -1, ""); }},
      {"page_token:", kInvalid, [&] { return revisions("mine", 0, "\x01garbage"); }},
      {"map:", kNotFound, [&] { return Veto("nowhere", kRight); }},
      {"map:", kInvalid, [&] { return Veto("No Where", kRight); }},
      {"id:", kNotFound, [&] { return Veto("mine", ""); }},
      {"id:", kNotFound, [&] { return Veto("mine", "anna/run1:15>anna/run1:3#1"); }},
      {"map:", kNotFound, [&] { return Force("nowhere", kRight); }},
      {"id:", kNotFound, [&] { return Force("mine", "anna/run1:15>anna/run1:4#0"); }},
      {"map:", kNotFound, [&] { return RollBack("nowhere", 1); }},
      {"revision:", kNotFound, [&] { return RollBack("mine", 0); }},
      {"revision:", kNotFound, [&] { return RollBack("mine", 99); }},
  };
  const uint64_t revision = Settle("mine").revision();
  for (const Case& bad : cases) {
    const grpc::Status status = bad.call();
    EXPECT_EQ(status.error_code(), bad.code) << bad.message << " " << status.error_message();
    EXPECT_THAT(status.error_message(), StartsWith(bad.message));
  }
  EXPECT_TRUE(explain("mine", anna0, 0).ok());
  EXPECT_EQ(Settle("mine").revision(), revision);  // none of it changed the map
}

}  // namespace
}  // namespace overtone
