// SPDX-License-Identifier: Apache-2.0
// The fixed parts of the report, compiled in from report_page.{html,css,js} (report.cmake).
#ifndef OVERTONE_CLIENT_CLI_REPORT_PAGE_H_
#define OVERTONE_CLIENT_CLI_REPORT_PAGE_H_

#include "absl/strings/string_view.h"

namespace overtone {

absl::string_view ReportTemplate();  // with {{title}}, {{style}}, ... where the other parts go
absl::string_view ReportStyle();
absl::string_view ReportScript();
absl::string_view ReportVersion();  // of Overtone, e.g. "0.1.0"

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_REPORT_PAGE_H_
