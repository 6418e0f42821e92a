// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/suggestion.h"

#include <algorithm>
#include <numeric>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"

namespace overtone {
namespace {

constexpr size_t kLongestName = 200;  // the distance to anything longer is not worth its time

absl::string_view LastPart(absl::string_view name) {
  const size_t dot = name.rfind('.');
  return dot == absl::string_view::npos ? name : name.substr(dot + 1);
}

int Distance(absl::string_view wanted, absl::string_view known) {
  const int whole = EditDistance(wanted, known);
  const int last_part = EditDistance(LastPart(wanted), LastPart(known)) + 1;
  const bool shortened = !wanted.empty() && absl::EndsWith(known, absl::StrCat("_", wanted));
  return std::min({whole, last_part, shortened ? 1 : whole});
}

}  // namespace

int EditDistance(absl::string_view a, absl::string_view b) {
  std::vector<int> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (size_t i = 0; i < a.size(); ++i) {
    int diagonal = row[0]++;
    for (size_t j = 0; j < b.size(); ++j) {
      const int replaced = diagonal + (a[i] != b[j]);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, diagonal + 1});
    }
  }
  return row.back();
}

std::string NearestName(absl::string_view wanted, const std::vector<std::string>& known) {
  if (wanted.size() > kLongestName) return "";
  int smallest = std::max<int>(2, static_cast<int>(wanted.size() / 3)) + 1;
  absl::string_view nearest;
  for (const std::string& name : known) {
    const int distance = Distance(wanted, name);
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
