// SPDX-License-Identifier: Apache-2.0
// What somebody who mistyped a name may have meant.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_SUGGESTION_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_SUGGESTION_H_

#include <string>
#include <vector>

#include "absl/strings/string_view.h"

namespace overtone {

// Insertions, deletions and replacements (Levenshtein), or `limit` when there are no fewer: it is
// given up as soon as that is certain, for names of very different lengths at once.
int EditDistance(absl::string_view a, absl::string_view b, int limit);

// The known name nearest to `wanted`; empty when none is near: more than a third of it would have
// to change, and it is not a known name without its section ("max_nodes") or in another one
// ("map.max_nodes"), of which again no more than a third may have to change.
std::string NearestName(absl::string_view wanted, const std::vector<std::string>& known);

// "; did you mean 'NAME'?", or nothing when there is none.
std::string DidYouMean(absl::string_view name);

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_SUGGESTION_H_
