// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdint>
#include <map>
#include <string>

#include "absl/time/clock.h"
#include "overtone/services/mapping_server/metrics/collectors.h"

namespace overtone {
namespace {

void CollectRevision(const std::string& map, const HostedMap::Published& published,
                     MetricSet& set) {
  const MapSnapshot& snapshot = *published.snapshot;
  int64_t anchored = 0, keyframes = 0;
  int components = 0;
  for (const SnapshotMission& mission : snapshot.missions) {
    anchored += mission.anchored ? 1 : 0;
    keyframes += static_cast<int64_t>(mission.keyframes.size());
    components = std::max(components, mission.component + 1);
  }
  const auto unanchored = static_cast<int64_t>(snapshot.missions.size()) - anchored;
  set.Add("overtone_missions", {map, "true"}, static_cast<double>(anchored));
  set.Add("overtone_missions", {map, "false"}, static_cast<double>(unanchored));
  set.Add("overtone_components", {map}, components);
  set.Add("overtone_keyframes", {map}, static_cast<double>(keyframes));
  set.Add("overtone_revision", {map}, static_cast<double>(snapshot.revision));
  set.Add("overtone_optimisation_seconds", {map}, snapshot.optimisation_s);
  if (snapshot.revision > 0) {
    set.Add("overtone_revision_age_seconds", {map},
            absl::ToDoubleSeconds(absl::Now() - published.time));
  }
  std::map<ClosureVerdict, int64_t> count;
  for (const ClosureRecord& record : snapshot.closures) ++count[record.verdict];
  for (const ClosureVerdict verdict : AllClosureVerdicts()) {
    set.Add("overtone_loop_closures", {map, std::string(ToString(verdict))},
            static_cast<double>(count[verdict]));
  }
}

void CollectStore(const HostedMap& map, MetricSet& set) {
  const StoreInstruments& store = map.instruments().store;
  set.Add("overtone_store_commit_seconds", {map.id()}, store.commit_s);
  set.Add("overtone_store_commit_entries", {map.id()}, store.commit_entries);
  set.Add("overtone_store_errors_total", {map.id()}, static_cast<double>(store.errors));
  const CloudCounts clouds = map.store().Clouds();
  set.Add("overtone_clouds", {map.id(), "stored"}, static_cast<double>(clouds.stored));
  set.Add("overtone_clouds", {map.id(), "missing"}, static_cast<double>(clouds.missing));
}

}  // namespace

void CollectMap(HostedMap& map, const DataDirectory& directory, MetricSet& set) {
  const int64_t backlog = map.backlog();  // before the revision: 0 must mean that it holds all
  CollectRevision(map.id(), map.published(), set);
  set.Add("overtone_front_end_backlog", {map.id()}, static_cast<double>(backlog));
  const HostedMap::QueueDepths depths = map.queue_depths();
  set.Add("overtone_queue_depth", {map.id(), "store"}, static_cast<double>(depths.store));
  set.Add("overtone_queue_depth", {map.id(), "detector"}, static_cast<double>(depths.detector));
  set.Add("overtone_queue_depth", {map.id(), "pipeline"}, static_cast<double>(depths.pipeline));
  for (size_t i = 0; i < kStageNames.size(); ++i) {
    set.Add("overtone_cycle_stage_seconds", {map.id(), kStageNames[i]},
            map.instruments().stage_s[i]);
  }
  CollectStore(map, set);
  set.Add("overtone_store_bytes", {map.id()}, static_cast<double>(directory.BytesOf(map.id())));
  set.Add("overtone_comparison_seconds", {map.id()}, map.reports().comparison_s());
}

}  // namespace overtone
