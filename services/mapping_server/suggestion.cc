// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/suggestion.h"

#include <algorithm>
#include <cstdlib>
#include <numeric>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"

namespace overtone {
namespace {

absl::string_view LastPart(absl::string_view name) {
  const size_t dot = name.rfind('.');
  return dot == absl::string_view::npos ? name : name.substr(dot + 1);
}

// From here on a name is another one.
int LimitFor(absl::string_view wanted) {
  return std::max<int>(2, static_cast<int>(wanted.size() / 3)) + 1;
}

// `limit` when it is not below that.
int Distance(absl::string_view wanted, absl::string_view known, int limit) {
  if (!wanted.empty() && absl::EndsWith(known, absl::StrCat("_", wanted))) return 1;
  const int whole = EditDistance(wanted, known, limit);
  const absl::string_view part = LastPart(wanted);
  const int part_limit = std::min(whole - 1, LimitFor(part));
  const int last_part = EditDistance(part, LastPart(known), part_limit);
  return last_part < part_limit ? last_part + 1 : whole;
}

}  // namespace

int EditDistance(absl::string_view a, absl::string_view b, int limit) {
  const int a_size = static_cast<int>(a.size());
  const int b_size = static_cast<int>(b.size());
  if (std::abs(a_size - b_size) >= limit) return limit;
  std::vector<int> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (int i = 0; i < a_size; ++i) {
    // Elsewhere prefixes differ by `limit` in their length alone.
    const int from = std::max(0, i + 1 - limit);
    const int to = std::min(b_size, i + limit);
    int diagonal = row[from];
    row[from] = from == 0 ? i + 1 : limit;
    int smallest = row[from];
    for (int j = from; j < to; ++j) {
      const int replaced = diagonal + (a[i] != b[j]);
      diagonal = row[j + 1];
      row[j + 1] = std::min(replaced, std::min(row[j], diagonal) + 1);
      smallest = std::min(smallest, row[j + 1]);
    }
    if (smallest >= limit) return limit;
  }
  return std::min(row.back(), limit);
}

std::string NearestName(absl::string_view wanted, const std::vector<std::string>& known) {
  int smallest = LimitFor(wanted);
  absl::string_view nearest;
  for (const std::string& name : known) {
    const int distance = Distance(wanted, name, smallest);
    if (distance >= smallest) continue;
    smallest = distance;
    nearest = name;
  }
  return std::string(nearest);
}

std::string DidYouMean(absl::string_view name) {
  return name.empty() ? "" : absl::StrCat("; did you mean '", name, "'?");
}

}  // namespace overtone
