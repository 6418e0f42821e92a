// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/report.h"

#include <fstream>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "overtone/client/cli/report_data.h"
#include "overtone/client/cli/report_page.h"
#include "overtone/client/cli/report_text.h"

namespace overtone {

std::string RenderReport(const RunResult& result) {
  // One pass over the template: what is inserted is not searched again.
  return absl::StrReplaceAll(ReportTemplate(), {{"{{title}}", ReportTitle(result)},
                                                {"{{style}}", ReportStyle()},
                                                {"{{team_note}}", TeamNote(result)},
                                                {"{{before}}", BeforeCaption(result)},
                                                {"{{after}}", AfterCaption(result)},
                                                {"{{overview}}", ReportOverview(result)},
                                                {"{{details}}", ReportDetails(result)},
                                                {"{{data}}", ReportData(result)},
                                                {"{{script}}", ReportScript()}});
}

absl::Status WriteReport(const RunResult& result, const std::string& path) {
  std::ofstream file(path, std::ios::binary);
  file << RenderReport(result);
  file.close();
  if (!file) return absl::UnavailableError(absl::StrCat(path, ": cannot write the report"));
  return absl::OkStatus();
}

}  // namespace overtone
