// SPDX-License-Identifier: Apache-2.0
// Revisits in real data: how many are proposed, how many proposals are right, and how good the yaw
// is. A revisit: a keyframe with another, more than 20 s before, less than 3 m away; where clouds
// are gathered, they share no scan. Proposals: the five most similar above a threshold.
#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "gtest/gtest.h"
#include "overtone/core/place_recognition/scan_context_index.h"
#include "overtone/core/place_recognition/scan_context_proposer.h"
#include "overtone/tests/core/place_recognition/public_scans.h"

namespace overtone {
namespace {

constexpr char kData[] = OVERTONE_SOURCE_DIR "/../shared/data/";
constexpr int kProposals = 5;
constexpr int kCandidates = 50;

struct Proposal {
  double similarity;
  double distance_m;  // of the two keyframes, in truth
  double yaw_error_deg;
};

struct Query {
  double nearest_m;  // the nearest place that may match, in truth
  std::vector<Proposal> proposals;
};

double Distance(const Rigid3d& a, const Rigid3d& b) {
  return (a.translation - b.translation).norm();
}

double YawErrorDegrees(const Rigid3d& from, const Rigid3d& to,
                       const Eigen::Quaterniond& from_R_to) {
  return from_R_to.angularDistance(from.rotation.conjugate() * to.rotation) * 180 / M_PI;
}

// Each keyframe asks for its like among those before it.
std::vector<Query> AskAll(const PublicScans& scans, double length_m, int candidates) {
  const ScanContextOptions options;
  ScanContextIndex index(options, candidates);
  std::vector<Eigen::Quaterniond> level_from_body;
  std::vector<Query> queries;
  for (size_t i = 0; i < scans.keyframes.size(); ++i) {
    const auto so_far = absl::MakeConstSpan(scans.keyframes).first(i + 1);
    const auto start = static_cast<int>(GatheringStart(so_far, length_m));
    level_from_body.push_back(LevelFromBody(scans.keyframes[i].mission_from_body.rotation));
    const ScanContext context =
        ComputeScanContext(GatherClouds(so_far, length_m), level_from_body[i], options);
    const auto may_match = [&](int place) {
      return place < start && scans.seconds[i] - scans.seconds[place] > 20;
    };
    Query query{1e9, {}};
    for (int place = 0; place < static_cast<int>(i); ++place) {
      if (!may_match(place)) continue;
      query.nearest_m = std::min(query.nearest_m, Distance(scans.truth[i], scans.truth[place]));
    }
    for (const PlaceMatch& match : index.Search(context, kProposals, may_match)) {
      const Rigid3d& place = scans.truth[match.place];
      query.proposals.push_back({match.similarity, Distance(scans.truth[i], place),
                                 YawErrorDegrees(scans.truth[i], place,
                                                 BodyRotation(level_from_body[i], match.yaw_rad,
                                                              level_from_body[match.place]))});
    }
    queries.push_back(std::move(query));
    index.Add(context);
  }
  return queries;
}

struct Figures {
  int revisits = 0;        // nearest < 3 m
  double recall = 0;       // of these, with a right proposal (< 3 m)
  double recall_near = 0;  // of the queries with a place < 1 m away
  double precision = 0;    // of all proposals, < 3 m
  double precision_6m = 0;
  double a_query = 0;  // proposals
  double median_yaw_deg = 0;
  double yaw_below_15 = 0;  // share of the right proposals
};

Figures Count(const std::vector<Query>& queries, double threshold) {
  Figures figures;
  int found = 0, near = 0, found_near = 0, right = 0, right_6m = 0, proposals = 0;
  std::vector<double> yaw_errors;
  for (const Query& query : queries) {
    bool hit = false;
    for (const Proposal& proposal : query.proposals) {
      if (proposal.similarity < threshold) continue;
      ++proposals;
      right_6m += proposal.distance_m < 6;
      if (proposal.distance_m >= 3) continue;
      hit = true;
      ++right;
      yaw_errors.push_back(proposal.yaw_error_deg);
    }
    figures.revisits += query.nearest_m < 3;
    found += query.nearest_m < 3 && hit;
    near += query.nearest_m < 1;
    found_near += query.nearest_m < 1 && hit;
  }
  std::sort(yaw_errors.begin(), yaw_errors.end());
  figures.recall = found / std::max(1.0, 1.0 * figures.revisits);
  figures.recall_near = found_near / std::max(1.0, 1.0 * near);
  figures.precision = right / std::max(1.0, 1.0 * proposals);
  figures.precision_6m = right_6m / std::max(1.0, 1.0 * proposals);
  figures.a_query = 1.0 * proposals / queries.size();
  if (yaw_errors.empty()) return figures;
  figures.median_yaw_deg = yaw_errors[yaw_errors.size() / 2];
  figures.yaw_below_15 =
      std::count_if(yaw_errors.begin(), yaw_errors.end(), [](double error) { return error < 15; }) /
      (1.0 * yaw_errors.size());
  return figures;
}

// Prints the table and returns the row at the default threshold.
Figures Report(const std::string& name, const PublicScans& scans, double length_m) {
  const std::vector<Query> queries = AskAll(scans, length_m, kCandidates);
  const Figures exhaustive =
      Count(AskAll(scans, length_m, static_cast<int>(scans.truth.size())), 0);
  Figures at_default;
  for (const double threshold : {0.0, 0.5, 0.6, 0.7, 0.8, 0.9}) {
    const Figures row = Count(queries, threshold);
    std::printf(
        "%-6s %4.0f m  >= %.1f  %4d revisits  recall %.2f (< 1 m: %.2f)  precision %.2f (< 6 m: "
        "%.2f)  %.1f a query  yaw: median %4.1f deg, < 15 deg %.2f\n",
        name.c_str(), length_m, threshold, row.revisits, row.recall, row.recall_near, row.precision,
        row.precision_6m, row.a_query, row.median_yaw_deg, row.yaw_below_15);
    if (threshold == ScanContextProposerOptions().min_similarity) at_default = row;
  }
  std::printf("%-6s %4.0f m  recall of %d candidates %.3f, of comparing all %.3f\n", name.c_str(),
              length_m, kCandidates, Count(queries, 0).recall, exhaustive.recall);
  EXPECT_GT(Count(queries, 0).recall, exhaustive.recall - 0.1);
  return at_default;
}

#define SKIP_WITHOUT(path) \
  if (!std::filesystem::exists(path)) GTEST_SKIP() << (path) << " is not there"

TEST(PublicPlaces, ALivoxOutdoorsFindsItsWayBack) {
  const std::string folder = std::string(kData) + "hku_livox";
  SKIP_WITHOUT(folder);
  const PublicScans scans = ReadHkuLivox(folder);
  const Figures alone = Report("hku", scans, 0);
  EXPECT_GT(alone.recall_near, 0.95);
  EXPECT_GT(alone.precision_6m, 0.3);
  EXPECT_LT(alone.median_yaw_deg, 5);
  EXPECT_GT(Report("hku", scans, 1).recall_near, 0.95);
  EXPECT_GT(Report("hku", scans, 5).recall_near, 0.8);
}

TEST(PublicPlaces, APlanarLaserIndoorsFindsMoreWhenItGathers) {
  const std::string folder = std::string(kData) + "radish_2d";
  SKIP_WITHOUT(folder);
  for (const auto& [name, no_return_m] : {std::pair("intel", 80.0), std::pair("aces", 50.0)}) {
    const PublicScans scans = ReadRadish(folder, name, no_return_m);
    ASSERT_GT(scans.truth.size(), 400u);
    const Figures alone = Report(name, scans, 0);
    const Figures gathered = Report(name, scans, 5);
    EXPECT_GT(gathered.recall_near, alone.recall_near) << name;
    EXPECT_GT(gathered.recall_near, 0.6) << name;
    EXPECT_LT(gathered.median_yaw_deg, 6) << name;
  }
}

}  // namespace
}  // namespace overtone
