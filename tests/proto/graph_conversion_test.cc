// SPDX-License-Identifier: Apache-2.0
#include "overtone/proto/conversion/graph_conversion.h"

#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/proto/conversion/published_graph.h"
#include "overtone/tests/proto/conversion_fixture.h"

namespace overtone {
namespace {

using ::testing::HasSubstr;
using testing::MakeGraph;
using testing::SameGraph;

constexpr int kSeed = 20240607;

GraphFormat Format(GraphEncoding encoding, bool include_edges = true) {
  GraphFormat format;
  format.map = "mine";
  format.encoding = encoding;
  format.include_edges = include_edges;
  return format;
}

MapGraph Published(const MapGraph& exact, const MapGraph& previous = MapGraph()) {
  return PublishedGraph(exact, previous, PublicationTolerance(), ColumnUnits());
}

double RotationError(const Rigid3d& a, const Rigid3d& b) {
  return LogSO3(a.rotation.conjugate() * b.rotation).norm();
}

TEST(GraphConversion, PlainKeepsEveryBitButThoseThatFloatWeightsCannot) {
  std::mt19937 random(kSeed);
  MapGraph graph = MakeGraph(random, 3, 50);
  for (MapEdge& edge : graph.edges) edge.weight = static_cast<float>(edge.weight);
  const auto decoded = FromProto(ToProto(graph, Format(v1::GRAPH_ENCODING_PLAIN)));
  ASSERT_TRUE(decoded.ok()) << decoded.status();
  EXPECT_TRUE(SameGraph(*decoded, graph));
}

TEST(GraphConversion, CompactStaysWithinHalfAUnitOfEachAxis) {
  std::mt19937 random(kSeed);
  const MapGraph graph = MakeGraph(random, 5, 400);
  const ColumnUnits units;
  const auto decoded = FromProto(ToProto(graph, Format(v1::GRAPH_ENCODING_COMPACT)));
  ASSERT_TRUE(decoded.ok()) << decoded.status();
  ASSERT_EQ(decoded->NumNodes(), graph.NumNodes());
  for (size_t m = 0; m < graph.missions.size(); ++m) {
    for (size_t i = 0; i < graph.missions[m].nodes.size(); ++i) {
      const MapNode& exact = graph.missions[m].nodes[i];
      const MapNode& sent = decoded->missions[m].nodes[i];
      EXPECT_EQ(sent.index, exact.index);
      EXPECT_LE(std::abs(sent.stamp.ns - exact.stamp.ns), units.stamp_ns / 2);
      const double position_error =
          (sent.map_from_body.translation - exact.map_from_body.translation).norm();
      EXPECT_LE(position_error, 0.5 * std::sqrt(3.0) * units.position_m + 1e-9);
      // The exponential never stretches: an error in the rotation vector bounds the one of the
      // rotation.
      EXPECT_LE(RotationError(sent.map_from_body, exact.map_from_body),
                0.5 * std::sqrt(3.0) * units.rotation_rad + 1e-9);
      EXPECT_EQ(sent.submap_start, exact.submap_start);
      EXPECT_EQ(sent.degenerate, exact.degenerate);
    }
  }
}

TEST(GraphConversion, RotationsNextToAHalfTurnSurviveTheColumns) {
  const ColumnUnits units;
  std::mt19937 random(kSeed);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 20000; ++i) {
    const Eigen::Vector3d axis =
        Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
    MapNode node;
    node.map_from_body.rotation = ExpSO3(axis * (M_PI + 1e-4 * normal(random)));
    const MapNode once = Quantised(node, units);
    EXPECT_LE(RotationError(once.map_from_body, node.map_from_body),
              std::sqrt(3.0) * units.rotation_rad);
    const MapNode twice = Quantised(once, units);
    ASSERT_TRUE(twice.map_from_body.rotation.coeffs() == once.map_from_body.rotation.coeffs()) << i;
  }
}

TEST(GraphConversion, CompactKeepsEveryBitOfAPublishedGraph) {
  std::mt19937 random(kSeed);
  const MapGraph graph = Published(MakeGraph(random, 4, 500));
  const auto decoded = FromProto(ToProto(graph, Format(v1::GRAPH_ENCODING_COMPACT)));
  ASSERT_TRUE(decoded.ok()) << decoded.status();
  EXPECT_TRUE(SameGraph(*decoded, graph));
}

TEST(GraphConversion, EdgesAreLeftOutUnlessAskedFor) {
  std::mt19937 random(kSeed);
  const MapGraph graph = MakeGraph(random, 1, 10);
  const v1::Graph message = ToProto(graph, Format(v1::GRAPH_ENCODING_PLAIN, false));
  EXPECT_FALSE(message.has_edges());
  EXPECT_EQ(message.edge_rule().radius_m(), 7.0);
  const auto decoded = FromProto(message);
  ASSERT_TRUE(decoded.ok()) << decoded.status();
  EXPECT_TRUE(decoded->edges.empty());
}

// What happens to a map from one revision to the next: poses move, nodes come and go, missions too.
MapGraph NextRevision(std::mt19937& random, const MapGraph& graph) {
  std::normal_distribution<double> normal;
  MapGraph next = graph;
  ++next.revision;
  for (MapMission& mission : next.missions) {
    for (MapNode& node : mission.nodes) {
      Vector6d step;
      for (int i = 0; i < 6; ++i) step[i] = 5e-4 * normal(random);
      node.map_from_body = node.map_from_body * Exp(step);
    }
    for (size_t i = mission.nodes.size() - 2; i > 0; i -= std::min<size_t>(i, 9)) {
      mission.nodes.erase(mission.nodes.begin() + i);
    }
    MapNode added = mission.nodes.back();
    added.index += 5;
    mission.nodes.push_back(added);
    MapNode between = mission.nodes.front();
    between.index = 0;
    mission.nodes.insert(mission.nodes.begin(), between);
  }
  next.missions[1].anchored = true;
  next.missions.erase(next.missions.begin() + 2);
  MapMission added = next.missions.back();
  added.id.robot = "zoe";
  next.missions.push_back(added);
  next.edges.resize(next.edges.size() / 2);
  return next;
}

class DeltaLaw : public ::testing::TestWithParam<GraphEncoding> {};

TEST_P(DeltaLaw, ApplyingTheDifferenceGivesTheTarget) {
  std::mt19937 random(kSeed);
  const MapGraph base_exact = MakeGraph(random, 5, 120);
  const MapGraph base = Published(base_exact);
  const MapGraph target = Published(NextRevision(random, base_exact), base);
  const auto applied = ApplyDelta(base, MakeDelta(base, target, Format(GetParam())));
  ASSERT_TRUE(applied.ok()) << applied.status();
  EXPECT_TRUE(SameGraph(*applied, target));
}

TEST_P(DeltaLaw, TheDifferenceOfEqualGraphsHoldsNoMissions) {
  std::mt19937 random(kSeed);
  const MapGraph base = Published(MakeGraph(random, 3, 40));
  MapGraph target = base;
  ++target.revision;
  const v1::GraphDelta delta = MakeDelta(base, target, Format(GetParam()));
  EXPECT_EQ(delta.changes().missions_size(), 0);
  const auto applied = ApplyDelta(base, delta);
  ASSERT_TRUE(applied.ok()) << applied.status();
  EXPECT_TRUE(SameGraph(*applied, target));
}

TEST_P(DeltaLaw, ADeltaFromNothingIsTheWholeGraph) {
  std::mt19937 random(kSeed);
  const MapGraph target = Published(MakeGraph(random, 3, 40));
  MapGraph base;
  base.map_epoch = target.map_epoch;
  const auto applied = ApplyDelta(base, MakeDelta(base, target, Format(GetParam())));
  ASSERT_TRUE(applied.ok()) << applied.status();
  EXPECT_TRUE(SameGraph(*applied, target));
}

INSTANTIATE_TEST_SUITE_P(BothEncodings, DeltaLaw,
                         ::testing::Values(v1::GRAPH_ENCODING_PLAIN, v1::GRAPH_ENCODING_COMPACT));

TEST(PublishedGraph, NeverStraysFromTheExactPosesByMoreThanTheTolerance) {
  std::mt19937 random(kSeed);
  std::normal_distribution<double> normal;
  const PublicationTolerance tolerance;
  MapGraph exact = MakeGraph(random, 2, 200);
  MapGraph published = Published(exact);
  // A slow drift in one direction: errors must not pile up.
  for (int revision = 0; revision < 50; ++revision) {
    for (MapMission& mission : exact.missions) {
      for (MapNode& node : mission.nodes) {
        node.map_from_body.translation.x() += 4e-4;
        node.map_from_body.rotation =
            node.map_from_body.rotation * ExpSO3(Eigen::Vector3d(0, 1e-4 * normal(random), 0));
      }
    }
    ++exact.revision;
    published = Published(exact, published);
    for (size_t m = 0; m < exact.missions.size(); ++m) {
      for (size_t i = 0; i < exact.missions[m].nodes.size(); ++i) {
        const Rigid3d& a = exact.missions[m].nodes[i].map_from_body;
        const Rigid3d& b = published.missions[m].nodes[i].map_from_body;
        ASSERT_LE((a.translation - b.translation).norm(), tolerance.position_m);
        ASSERT_LE(RotationError(a, b), tolerance.rotation_rad);
      }
    }
  }
}

TEST(PublishedGraph, PosesThatMovedLessThanTheToleranceAreNotSentAgain) {
  std::mt19937 random(kSeed);
  const MapGraph exact = MakeGraph(random, 2, 100);
  const MapGraph first = Published(exact);
  MapGraph moved = exact;
  ++moved.revision;
  for (MapMission& mission : moved.missions) {
    for (MapNode& node : mission.nodes) node.map_from_body.translation.y() += 1e-3;
  }
  moved.missions[1].nodes[7].map_from_body.translation.y() += 1.0;
  const v1::GraphDelta delta =
      MakeDelta(first, Published(moved, first), Format(v1::GRAPH_ENCODING_PLAIN, false));
  ASSERT_EQ(delta.changes().missions_size(), 1);
  ASSERT_EQ(delta.changes().missions(0).nodes_size(), 1);
  EXPECT_EQ(delta.changes().missions(0).nodes(0).index(), 15);
}

TEST(PublishedGraph, ToleranceBelowTheRoundingIsRefused) {
  EXPECT_TRUE(PublicationTolerance().Validate(ColumnUnits()).ok());
  EXPECT_THAT(std::string((PublicationTolerance{1e-4, 5e-4}).Validate(ColumnUnits()).message()),
              HasSubstr("position_tolerance_m"));
  EXPECT_THAT(std::string((PublicationTolerance{2e-3, NAN}).Validate(ColumnUnits()).message()),
              HasSubstr("rotation_tolerance_rad"));
}

TEST(GraphDelta, ToAnotherRevisionOrEpochIsAFailedPrecondition) {
  std::mt19937 random(kSeed);
  const MapGraph base = Published(MakeGraph(random, 2, 20));
  MapGraph target = base;
  target.revision = 9;
  const v1::GraphDelta delta = MakeDelta(base, target, Format(v1::GRAPH_ENCODING_COMPACT));
  MapGraph other = base;
  other.revision = 6;
  EXPECT_EQ(ApplyDelta(other, delta).status().code(), absl::StatusCode::kFailedPrecondition);
  other = base;
  other.map_epoch = 2;
  EXPECT_EQ(ApplyDelta(other, delta).status().code(), absl::StatusCode::kFailedPrecondition);
}

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

struct HostileGraph {
  std::string name;
  GraphEncoding encoding;
  std::function<void(v1::Graph&)> spoil;
  std::string message;  // part of the error
};

std::vector<HostileGraph> HostileGraphs() {
  const GraphEncoding plain = v1::GRAPH_ENCODING_PLAIN;
  const GraphEncoding compact = v1::GRAPH_ENCODING_COMPACT;
  const auto columns = [](v1::Graph& g) { return g.mutable_missions(1)->mutable_columns(); };
  return {
      {"encoding", plain, [](auto& g) { g.set_encoding(v1::GRAPH_ENCODING_UNSPECIFIED); },
       "encoding:"},
      {"encoding 9", plain, [](auto& g) { g.set_encoding(static_cast<GraphEncoding>(9)); },
       "encoding:"},
      {"robot id", plain, [](auto& g) { g.mutable_missions(1)->mutable_id()->set_robot("../x"); },
       "missions[1].id.robot:"},
      {"no id", plain, [](auto& g) { g.mutable_missions(0)->clear_id(); }, "missions[0].id.robot:"},
      {"unsorted", plain, [](auto& g) { g.mutable_missions()->SwapElements(0, 1); },
       "missions[1].id:"},
      {"twin", plain, [](auto& g) { *g.mutable_missions(1)->mutable_id() = g.missions(0).id(); },
       "missions[1].id:"},
      {"component", plain, [](auto& g) { g.mutable_missions(0)->set_component(-1); },
       "missions[0].component:"},
      {"no mission pose", plain, [](auto& g) { g.mutable_missions(0)->clear_map_tform_mission(); },
       "missions[0].map_tform_mission.position:"},
      {"no node pose", plain,
       [](auto& g) { g.mutable_missions(0)->mutable_nodes(2)->clear_map_tform_body(); },
       "missions[0].nodes[2].map_tform_body.position:"},
      {"nan", plain,
       [](auto& g) {
         g.mutable_missions(0)
             ->mutable_nodes(2)
             ->mutable_map_tform_body()
             ->mutable_position()
             ->set_z(kNan);
       },
       "missions[0].nodes[2].map_tform_body.position.z:"},
      {"quaternion", plain,
       [](auto& g) {
         g.mutable_missions(0)
             ->mutable_nodes(2)
             ->mutable_map_tform_body()
             ->mutable_orientation()
             ->set_w(4);
       },
       "missions[0].nodes[2].map_tform_body.orientation:"},
      {"index twice", plain, [](auto& g) { g.mutable_missions(0)->mutable_nodes(2)->set_index(3); },
       "missions[0].nodes:"},
      {"index huge", plain,
       [](auto& g) { g.mutable_missions(0)->mutable_nodes(2)->set_index(INT64_MAX); },
       "missions[0].nodes[2].index:"},
      {"stamp", plain, [](auto& g) { g.mutable_missions(0)->mutable_nodes(2)->set_stamp_ns(-1); },
       "missions[0].nodes[2].stamp_ns:"},
      {"columns in plain", plain, [](auto& g) { g.mutable_missions(0)->mutable_columns(); },
       "missions[0].columns:"},
      {"removed in whole graph", plain, [](auto& g) { g.mutable_missions(0)->add_removed(1); },
       "missions[0].removed:"},
      {"nodes in compact", compact, [](auto& g) { g.mutable_missions(0)->add_nodes(); },
       "missions[0].nodes:"},
      {"no resolution", compact, [](auto& g) { g.clear_position_resolution_m(); },
       "position_resolution_m:"},
      {"nan resolution", compact, [](auto& g) { g.set_rotation_resolution_rad(kNan); },
       "rotation_resolution_rad:"},
      {"inf resolution", compact, [](auto& g) { g.set_position_resolution_m(kInf); },
       "position_resolution_m:"},
      {"stamp resolution", compact, [](auto& g) { g.set_stamp_resolution_ns(0); },
       "stamp_resolution_ns:"},
      {"column short", compact, [=](auto& g) { columns(g)->mutable_y()->RemoveLast(); },
       "missions[1].columns.y:"},
      {"column missing", compact, [=](auto& g) { columns(g)->clear_rz(); },
       "missions[1].columns.rz:"},
      {"flags short", compact, [=](auto& g) { columns(g)->mutable_flags()->RemoveLast(); },
       "missions[1].columns.flags:"},
      {"flags unknown", compact, [=](auto& g) { columns(g)->set_flags(3, 8); },
       "missions[1].columns.flags:"},
      {"sum overflows", compact,
       [=](auto& g) {
         columns(g)->set_x(3, INT64_MAX);
         columns(g)->set_x(4, INT64_MAX);
       },
       "missions[1].columns."},
      {"negative sum overflows", compact,
       [=](auto& g) {
         columns(g)->set_index(0, INT64_MIN);
         columns(g)->set_index(1, INT64_MIN);
       },
       "missions[1].columns.index"},
      {"stamp overflows", compact, [=](auto& g) { columns(g)->set_stamp(3, INT64_MAX / 2); },
       "missions[1].columns.stamp"},
      {"position far", compact, [=](auto& g) { columns(g)->set_z(3, int64_t{1} << 60); },
       "missions[1].columns.position.z:"},
      {"rotation long", compact, [=](auto& g) { columns(g)->set_rx(3, 100000); },
       "missions[1].columns.rx:"},
      {"rotation huge", compact, [=](auto& g) { columns(g)->set_ry(3, int64_t{1} << 62); },
       "missions[1].columns.rx:"},
      {"index twice in columns", compact, [=](auto& g) { columns(g)->set_index(3, 0); },
       "missions[1].columns.index:"},
      {"index back in columns", compact, [=](auto& g) { columns(g)->set_index(3, -2); },
       "missions[1].columns.index:"},
      {"edge columns", plain, [](auto& g) { g.mutable_edges()->add_first(0); }, "edges:"},
      {"edge backwards", plain, [](auto& g) { g.mutable_edges()->set_first(2, -1); },
       "edges.first[2]:"},
      {"edge to itself", plain, [](auto& g) { g.mutable_edges()->set_span(2, 0); },
       "edges.span[2]:"},
      {"edge beyond", plain, [](auto& g) { g.mutable_edges()->set_span(2, 0xffffffffu); },
       "edges.span[2]:"},
      {"edge first beyond", plain, [](auto& g) { g.mutable_edges()->set_first(2, INT32_MAX); },
       "edges.span[2]:"},
      {"edge weight nan", plain, [](auto& g) { g.mutable_edges()->set_weight(2, NAN); },
       "edges.weight[2]:"},
      {"edge weight zero", plain, [](auto& g) { g.mutable_edges()->set_weight(2, 0); },
       "edges.weight[2]:"},
  };
}

TEST(GraphConversion, EveryHostileGraphIsRefusedWithItsFieldPath) {
  std::mt19937 random(kSeed);
  const MapGraph graph = MakeGraph(random, 2, 20);
  for (const HostileGraph& hostile : HostileGraphs()) {
    v1::Graph message = ToProto(graph, Format(hostile.encoding));
    ASSERT_TRUE(FromProto(message).ok());
    hostile.spoil(message);
    const absl::Status status = FromProto(message).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << hostile.name;
    EXPECT_THAT(std::string(status.message()), ::testing::StartsWith(hostile.message))
        << hostile.name;
  }
}

struct HostileDelta {
  std::string name;
  std::function<void(v1::GraphDelta&)> spoil;
  std::string message;
};

TEST(GraphDelta, EveryHostileDeltaIsRefusedWithItsFieldPath) {
  std::mt19937 random(kSeed);
  const MapGraph base = Published(MakeGraph(random, 4, 30));
  const MapGraph target = Published(NextRevision(random, base), base);
  const std::vector<HostileDelta> cases = {
      {"revision", [](auto& d) { d.mutable_changes()->set_revision(7); }, "changes.revision:"},
      {"removed unknown",
       [](auto& d) { d.mutable_changes()->mutable_missions(0)->add_removed(1 << 20); },
       "changes.missions[0].removed:"},
      {"removed unsorted",
       [](auto& d) { d.mutable_changes()->mutable_missions(0)->add_removed(-1); },
       "changes.missions[0].removed["},
      {"mission unknown", [](auto& d) { d.mutable_removed_missions(0)->set_robot("nobody"); },
       "removed_missions[0]:"},
      {"mission id", [](auto& d) { d.mutable_removed_missions(0)->set_robot("\n"); },
       "removed_missions[0].robot:"},
      {"columns",
       [](auto& d) { d.mutable_changes()->mutable_missions(0)->mutable_columns()->add_x(1); },
       "changes.missions[0].columns.x:"},
      {"edges", [](auto& d) { d.mutable_changes()->mutable_edges()->set_span(0, 1 << 30); },
       "changes.edges.span[0]:"},
  };
  for (const HostileDelta& hostile : cases) {
    v1::GraphDelta delta = MakeDelta(base, target, Format(v1::GRAPH_ENCODING_COMPACT));
    ASSERT_TRUE(ApplyDelta(base, delta).ok());
    hostile.spoil(delta);
    const absl::Status status = ApplyDelta(base, delta).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << hostile.name;
    EXPECT_THAT(std::string(status.message()), ::testing::StartsWith(hostile.message))
        << hostile.name;
  }
}

// Cuts and flips the bytes of valid messages: decoding must answer, never crash. Run under ASan and
// UBSan too.
TEST(GraphConversion, DamagedBytesNeverCrashTheDecoders) {
  std::mt19937 random(kSeed);
  const MapGraph base = Published(MakeGraph(random, 4, 12));
  const MapGraph target = Published(NextRevision(random, base), base);
  int refused = 0;
  for (const GraphEncoding encoding : {v1::GRAPH_ENCODING_PLAIN, v1::GRAPH_ENCODING_COMPACT}) {
    const std::string whole = ToProto(base, Format(encoding)).SerializeAsString();
    const std::string delta = MakeDelta(base, target, Format(encoding)).SerializeAsString();
    for (int i = 0; i < 4000; ++i) {
      std::string bytes = i % 2 == 0 ? whole : delta;
      if (i % 3 == 0) bytes.resize(random() % bytes.size());
      for (int flips = random() % 4; flips > 0 && !bytes.empty(); --flips) {
        bytes[random() % bytes.size()] ^= static_cast<char>(1 << random() % 8);
      }
      v1::Graph graph_message;
      v1::GraphDelta delta_message;
      if (i % 2 == 0) {
        refused += !graph_message.ParseFromString(bytes) || !FromProto(graph_message).ok();
      } else {
        refused += !delta_message.ParseFromString(bytes) || !ApplyDelta(base, delta_message).ok();
      }
    }
  }
  EXPECT_GT(refused, 2000);
}

}  // namespace
}  // namespace overtone
