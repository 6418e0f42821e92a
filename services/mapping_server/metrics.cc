// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/metrics.h"

#include <map>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "prometheus/client_metric.h"
#include "prometheus/collectable.h"
#include "prometheus/exposer.h"
#include "prometheus/metric_family.h"

namespace overtone {
namespace {

using prometheus::MetricFamily;
using prometheus::MetricType;
using Labels = std::vector<std::pair<std::string, std::string>>;

MetricFamily Gauge(const std::string& name, const std::string& help) {
  MetricFamily family;
  family.name = name;
  family.help = help;
  family.type = MetricType::Gauge;
  return family;
}

void AddValue(MetricFamily& family, const Labels& labels, double value) {
  prometheus::ClientMetric metric;
  for (const auto& [name, label] : labels) metric.label.push_back({name, label});
  metric.gauge.value = value;
  family.metric.push_back(std::move(metric));
}

class MapMetrics final : public prometheus::Collectable {
 public:
  explicit MapMetrics(const MapRegistry* registry) : registry_(registry) {}

  std::vector<MetricFamily> Collect() const override {
    MetricFamily closures = Gauge("overtone_loop_closures", "Candidates of the newest revision");
    MetricFamily backlog =
        Gauge("overtone_front_end_backlog", "Clouds, candidates and submaps not in a revision yet");
    MetricFamily revision = Gauge("overtone_revision", "Newest revision");
    MetricFamily age = Gauge("overtone_revision_age_seconds", "Since it was published");
    MetricFamily missions = Gauge("overtone_missions", "Missions of the newest revision");
    MetricFamily keyframes = Gauge("overtone_keyframes", "Keyframes of the newest revision");
    MetricFamily solve = Gauge("overtone_optimisation_seconds", "Of the newest revision");
    for (const std::shared_ptr<HostedMap>& map : registry_->List()) {
      const int64_t waiting = map->backlog();  // before the revision: 0 must mean that it holds all
      const HostedMap::Published published = map->published();
      const MapSnapshot& snapshot = *published.snapshot;
      std::map<ClosureVerdict, int64_t> count;
      for (const ClosureRecord& record : snapshot.closures) ++count[record.verdict];
      for (const ClosureVerdict verdict : AllClosureVerdicts()) {
        AddValue(closures, {{"map", map->id()}, {"verdict", std::string(ToString(verdict))}},
                 static_cast<double>(count[verdict]));
      }
      int64_t anchored = 0, nodes = 0;
      for (const SnapshotMission& mission : snapshot.missions) {
        anchored += mission.anchored;
        nodes += static_cast<int64_t>(mission.keyframes.size());
      }
      const auto unanchored = static_cast<int64_t>(snapshot.missions.size()) - anchored;
      AddValue(missions, {{"map", map->id()}, {"anchored", "true"}}, static_cast<double>(anchored));
      AddValue(missions, {{"map", map->id()}, {"anchored", "false"}},
               static_cast<double>(unanchored));
      const Labels labels = {{"map", map->id()}};
      AddValue(keyframes, labels, static_cast<double>(nodes));
      AddValue(backlog, labels, static_cast<double>(waiting));
      AddValue(revision, labels, static_cast<double>(snapshot.revision));
      AddValue(solve, labels, snapshot.optimisation_s);
      if (snapshot.revision > 0) {
        AddValue(age, labels, absl::ToDoubleSeconds(absl::Now() - published.time));
      }
    }
    return {closures, backlog, revision, age, missions, keyframes, solve};
  }

 private:
  const MapRegistry* const registry_;
};

}  // namespace

struct MetricsEndpoint::Impl {
  std::shared_ptr<MapMetrics> metrics;
  std::unique_ptr<prometheus::Exposer> exposer;
};

MetricsEndpoint::MetricsEndpoint(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
MetricsEndpoint::~MetricsEndpoint() = default;

int MetricsEndpoint::port() const { return impl_->exposer->GetListeningPorts().front(); }

absl::StatusOr<std::unique_ptr<MetricsEndpoint>> MetricsEndpoint::Start(
    const std::string& listen, const MapRegistry* registry) {
  auto impl = std::make_unique<Impl>();
  impl->metrics = std::make_shared<MapMetrics>(registry);
  try {
    impl->exposer = std::make_unique<prometheus::Exposer>(listen);
    impl->exposer->RegisterCollectable(impl->metrics);
  } catch (const std::exception& error) {
    return absl::UnavailableError(
        absl::StrCat("metrics_listen: cannot listen on ", listen, ": ", error.what()));
  }
  return std::unique_ptr<MetricsEndpoint>(new MetricsEndpoint(std::move(impl)));
}

}  // namespace overtone
