// SPDX-License-Identifier: Apache-2.0
// What became of loop closures, and relations' errors, in words and in metrics.json.
#ifndef OVERTONE_CLIENT_CLI_CLOSURE_SUMMARY_H_
#define OVERTONE_CLIENT_CLI_CLOSURE_SUMMARY_H_

#include <string>

#include "overtone/client/cli/json_codec.h"
#include "overtone/client/cli/run_result.h"

namespace overtone {

// For each proposer a line: proposed, accepted, accepted wrong, rejected by verdict (and how many
// of those truly are one place); precision and recall where the ground truth knows.
std::string FormatClosures(const RunResult& result);

// {"scan_context": {"proposed", "judged", "same_place", "accepted", "accepted_judged",
// "accepted_wrong", "precision", "recall", "verdicts": {"rejected_score": {"count",
// "same_place"}}}}; absent figures null.
Json ClosuresToJson(const RunResult& result);

// A table: estimate, relations, translation median and mean, rotation median and mean. Empty
// without relations.
std::string FormatRelations(const RunResult& result);

// {"onboard": {"count", "translation_mean_m", ...}, ...}, null where there is nothing to compare.
Json RelationsToJson(const RunResult& result);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_CLOSURE_SUMMARY_H_
