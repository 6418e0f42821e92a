// SPDX-License-Identifier: Apache-2.0
// Pages of a sorted list. A token names the last key of its page, so that a list that grows
// meanwhile neither repeats nor skips what was there before.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_PAGINATION_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_PAGINATION_H_

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace overtone {

struct Page {
  size_t begin = 0;  // positions in the list
  size_t end = 0;
  std::string next_page_token;  // empty: the last page
};

// `keys`: strictly increasing, of printable ASCII. page_size 0 means 100. InvalidArgument:
// page_size outside [0, 1000], or a token that no page gave.
absl::StatusOr<Page> SelectPage(const std::vector<std::string>& keys, int32_t page_size,
                                const std::string& page_token);

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_PAGINATION_H_
