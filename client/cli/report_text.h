// SPDX-License-Identifier: Apache-2.0
// The report in words and tables, as escaped HTML: readable without scripts.
#ifndef OVERTONE_CLIENT_CLI_REPORT_TEXT_H_
#define OVERTONE_CLIENT_CLI_REPORT_TEXT_H_

#include <string>

#include "absl/strings/string_view.h"
#include "overtone/client/cli/run_result.h"

namespace overtone {

std::string EscapeHtml(absl::string_view text);

std::string ReportTitle(const RunResult& result);
// What the pictures of the team show, and the titles of the two.
std::string TeamNote(const RunResult& result);
std::string BeforeCaption(const RunResult& result);
std::string AfterCaption(const RunResult& result);
// What was run, the errors before and after, and the table of the terminal.
std::string ReportOverview(const RunResult& result);
// Loop closures by verdict, settings, version.
std::string ReportDetails(const RunResult& result);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_REPORT_TEXT_H_
