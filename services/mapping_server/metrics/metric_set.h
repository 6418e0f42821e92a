// SPDX-License-Identifier: Apache-2.0
// One answer to a Prometheus server, filled by the collectors.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_METRICS_METRIC_SET_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_METRICS_METRIC_SET_H_

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "absl/strings/string_view.h"
#include "overtone/services/mapping_server/metrics/histogram.h"
#include "prometheus/client_metric.h"
#include "prometheus/metric_family.h"

namespace overtone {

struct MetricDescription {
  std::string name;
  prometheus::MetricType type;
  std::vector<std::string> labels;
  std::string help;
};

// All that this server exposes; docs/metrics.md lists the same.
const std::vector<MetricDescription>& MetricDescriptions();

// Not thread-safe.
class MetricSet {
 public:
  // Every description as a family without values.
  MetricSet();

  // `labels`: values, in the order of the description, which must be there.
  void Add(absl::string_view name, const std::vector<std::string>& labels, double value);
  template <size_t kBounds>
  void Add(absl::string_view name, const std::vector<std::string>& labels,
           const Histogram<kBounds>& histogram) {
    const auto& bounds = histogram.bounds();
    AddHistogram(name, labels, {bounds.begin(), bounds.end()}, histogram.Counts(), histogram.Sum());
  }

  std::vector<prometheus::MetricFamily> Take();

 private:
  prometheus::ClientMetric& AddMetric(absl::string_view name,
                                      const std::vector<std::string>& labels);
  void AddHistogram(absl::string_view name, const std::vector<std::string>& labels,
                    const std::vector<double>& bounds, const std::vector<uint64_t>& counts,
                    double sum);

  std::vector<prometheus::MetricFamily> families_;  // as MetricDescriptions()
  std::map<std::string, size_t, std::less<>> by_name_;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_METRICS_METRIC_SET_H_
