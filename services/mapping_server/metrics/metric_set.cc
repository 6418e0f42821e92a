// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/metrics/metric_set.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace overtone {

using prometheus::ClientMetric;
using prometheus::MetricFamily;
using prometheus::MetricType;

MetricSet::MetricSet() {
  for (const MetricDescription& description : MetricDescriptions()) {
    MetricFamily family;
    family.name = description.name;
    family.help = description.help;
    family.type = description.type;
    by_name_[description.name] = families_.size();
    families_.push_back(std::move(family));
  }
}

ClientMetric& MetricSet::AddMetric(absl::string_view name, const std::vector<std::string>& labels) {
  const size_t index = by_name_.find(name)->second;
  const std::vector<std::string>& names = MetricDescriptions()[index].labels;
  ClientMetric metric;
  for (size_t i = 0; i < std::min(names.size(), labels.size()); ++i) {
    metric.label.push_back({names[i], labels[i]});
  }
  families_[index].metric.push_back(std::move(metric));
  return families_[index].metric.back();
}

void MetricSet::Add(absl::string_view name, const std::vector<std::string>& labels, double value) {
  ClientMetric& metric = AddMetric(name, labels);
  metric.counter.value = value;  // of these two the family's type tells which is written
  metric.gauge.value = value;
}

void MetricSet::AddHistogram(absl::string_view name, const std::vector<std::string>& labels,
                             const std::vector<double>& bounds, const std::vector<uint64_t>& counts,
                             double sum) {
  ClientMetric::Histogram& histogram = AddMetric(name, labels).histogram;
  for (size_t i = 0; i < counts.size(); ++i) {
    histogram.sample_count += counts[i];
    const double bound = i < bounds.size() ? bounds[i] : std::numeric_limits<double>::infinity();
    histogram.bucket.push_back({histogram.sample_count, bound});
  }
  histogram.sample_sum = sum;
}

std::vector<MetricFamily> MetricSet::Take() { return std::exchange(families_, {}); }

}  // namespace overtone
