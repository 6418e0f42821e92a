// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/pagination.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "absl/strings/strip.h"
#include "overtone/proto/conversion/field_path.h"

namespace overtone {
namespace {

constexpr absl::string_view kTokenPrefix = "after:";
constexpr int kDefaultPageSize = 100;
constexpr int kMaxPageSize = 1000;

}  // namespace

absl::StatusOr<Page> SelectPage(const std::vector<std::string>& keys, int32_t page_size,
                                const std::string& page_token) {
  if (page_size < 0 || page_size > kMaxPageSize) {
    return InvalidField("page_size", absl::StrCat(page_size, " is not in [0, 1000]"));
  }
  absl::string_view last_key = page_token;
  Page page;
  if (!page_token.empty()) {
    if (!absl::ConsumePrefix(&last_key, kTokenPrefix)) {
      return InvalidField("page_token", "not from an earlier page");
    }
    page.begin = std::upper_bound(keys.begin(), keys.end(), last_key) - keys.begin();
  }
  const size_t size = page_size == 0 ? kDefaultPageSize : page_size;
  page.end = std::min(keys.size(), page.begin + size);
  if (page.end < keys.size()) page.next_page_token = absl::StrCat(kTokenPrefix, keys[page.end - 1]);
  return page;
}

}  // namespace overtone
