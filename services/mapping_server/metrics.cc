// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/metrics.h"

#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "overtone/services/mapping_server/metrics/collectors.h"
#include "overtone/services/mapping_server/metrics/metric_set.h"
#include "prometheus/collectable.h"
#include "prometheus/exposer.h"

namespace overtone {
namespace {

class ServerMetrics final : public prometheus::Collectable {
 public:
  explicit ServerMetrics(const MetricSources& sources) : sources_(sources) {}

  std::vector<prometheus::MetricFamily> Collect() const override {
    MetricSet set;
    set.Add("overtone_build_info", {OVERTONE_VERSION}, 1);
    CollectProcess(set);
    CollectRpcs(*sources_.rpcs, set);
    CollectQuotas(sources_.quotas->refusals(), set);
    const DataDirectory& directory = sources_.registry->directory();
    if (!directory.InMemory()) CollectDisk(directory.path(), set);
    const std::vector<std::shared_ptr<HostedMap>> maps = sources_.registry->List();
    set.Add("overtone_maps", {}, static_cast<double>(maps.size()));
    for (const std::shared_ptr<HostedMap>& map : maps) {
      CollectMap(*map, directory, set);
      CollectRobots(*map, *sources_.sessions, set);
    }
    return set.Take();
  }

 private:
  const MetricSources sources_;
};

}  // namespace

struct MetricsEndpoint::Impl {
  std::shared_ptr<ServerMetrics> metrics;
  std::unique_ptr<prometheus::Exposer> exposer;
};

MetricsEndpoint::MetricsEndpoint(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
MetricsEndpoint::~MetricsEndpoint() = default;

int MetricsEndpoint::port() const { return impl_->exposer->GetListeningPorts().front(); }

absl::StatusOr<std::unique_ptr<MetricsEndpoint>> MetricsEndpoint::Start(
    const std::string& listen, const MetricSources& sources) {
  auto impl = std::make_unique<Impl>();
  impl->metrics = std::make_shared<ServerMetrics>(sources);
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
