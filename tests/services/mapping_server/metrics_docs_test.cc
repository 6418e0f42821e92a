// SPDX-License-Identifier: Apache-2.0
// docs/metrics.md against what a server exposes that has seen everything once.
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/tests/services/mapping_server/server_fixture.h"
#include "overtone/tests/support/http_get.h"
#include "overtone/tests/support/temporary_directory.h"

namespace overtone {
namespace {

const MissionId kAnna = {"anna", "run1"};

struct Metric {
  std::string type;
  std::string help;
  std::set<std::string> labels;
};
using Metrics = std::map<std::string, Metric>;

std::string Slurp(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

// "| `name` | type | `label`, `label` | meaning |"
Metrics Documented() {
  Metrics metrics;
  for (absl::string_view line :
       absl::StrSplit(Slurp(OVERTONE_SOURCE_DIR "/docs/metrics.md"), '\n')) {
    const std::vector<std::string> cells = absl::StrSplit(line, '|');
    if (cells.size() != 6 || !absl::StartsWith(cells[1], " `")) continue;
    const auto bare = [](absl::string_view cell) {
      return std::string(
          absl::StripSuffix(absl::StripPrefix(absl::StripAsciiWhitespace(cell), "`"), "`"));
    };
    Metric& metric = metrics[bare(cells[1])];
    metric.type = bare(cells[2]);
    metric.help = bare(cells[4]);
    for (absl::string_view label : absl::StrSplit(cells[3], ',', absl::SkipWhitespace())) {
      metric.labels.insert(bare(label));
    }
  }
  return metrics;
}

// The family of a sample, e.g. of a histogram's _bucket.
std::string FamilyOf(absl::string_view sample, const Metrics& metrics) {
  for (const char* suffix : {"", "_bucket", "_sum", "_count"}) {
    const std::string name(absl::StripSuffix(sample, suffix));
    if (metrics.count(name) > 0) return name;
  }
  return std::string(sample);
}

// The text format: HELP, TYPE, and samples with their labels.
Metrics Exposed(const std::string& scrape, std::set<std::string>& with_samples) {
  Metrics metrics;
  for (absl::string_view line : absl::StrSplit(scrape, '\n')) {
    const std::vector<std::string> words = absl::StrSplit(line, absl::MaxSplits(' ', 3));
    if (words.size() == 4 && words[0] == "#") {
      (words[1] == "HELP" ? metrics[words[2]].help : metrics[words[2]].type) = words[3];
    } else if (absl::StrContains(line, ' ') && !metrics.empty()) {
      const std::string sample(line.substr(0, line.find_first_of("{ ")));
      const std::string family = FamilyOf(sample, metrics);
      with_samples.insert(family);
      if (!absl::StrContains(line, '{')) continue;
      const size_t open = line.find('{'), close = line.rfind('}');
      for (absl::string_view label :
           absl::StrSplit(line.substr(open + 1, close - open - 1), ',', absl::SkipEmpty())) {
        const std::string name(label.substr(0, label.find('=')));
        if (name != "le" && name != "quantile") metrics[family].labels.insert(name);
      }
    }
  }
  return metrics;
}

class MetricsDocsTest : public testing::ServerTest {
 protected:
  void SetUp() override {
    ServerOptions options = testing::TestOptions();
    options.data_dir = folder_.File("data");
    options.metrics_listen = "127.0.0.1:0";
    StartServer(options);
    Upload("mine", kAnna, 1, 5);
    v1::ReportStatusRequest request;
    request.set_map("mine");
    *request.mutable_mission() = ToProto(kAnna);
    request.mutable_link()->mutable_clock_offset()->set_nanos(1);
    request.mutable_comparison()->set_nodes(1);
    v1::ReportStatusResponse response;
    grpc::ClientContext context;
    ASSERT_TRUE(mapping_->ReportStatus(&context, request, &response).ok());
    Settle("mine");
    HttpGet(server_->metrics_port(), "/metrics");  // of which the next one tells
    const std::string answer = HttpGet(server_->metrics_port(), "/metrics");
    scrape_ = answer.substr(answer.find("\r\n\r\n") + 4);
  }

  void TearDown() override { server_.reset(); }  // before its folder goes

  TemporaryDirectory folder_;
  std::string scrape_;
};

TEST_F(MetricsDocsTest, TheTableIsWhatIsExposed) {
  const Metrics documented = Documented();
  std::set<std::string> with_samples;
  const Metrics exposed = Exposed(scrape_, with_samples);
  EXPECT_GT(exposed.size(), 40u);
  for (const auto& [name, metric] : exposed) {
    const auto row = documented.find(name);
    if (row == documented.end()) {
      ADD_FAILURE() << name << " is exposed, and not in docs/metrics.md";
      continue;
    }
    EXPECT_EQ(row->second.type, metric.type) << name;
    EXPECT_EQ(row->second.help, metric.help) << name;
    EXPECT_EQ(absl::StrJoin(row->second.labels, " "), absl::StrJoin(metric.labels, " ")) << name;
    EXPECT_EQ(with_samples.count(name), 1u) << name << " has no value in this test";
  }
  for (const auto& [name, metric] : documented) {
    EXPECT_EQ(exposed.count(name), 1u) << name << " is in docs/metrics.md, and not exposed";
  }
}

TEST_F(MetricsDocsTest, PromtoolFindsNothingToSay) {
  if (std::system("command -v promtool > /dev/null") != 0) GTEST_SKIP() << "no promtool";
  // The endpoint's own, which its library names.
  std::string ours;
  for (absl::string_view line : absl::StrSplit(scrape_, '\n')) {
    if (!absl::StrContains(line, "exposer_")) absl::StrAppend(&ours, line, "\n");
  }
  std::ofstream(folder_.File("scrape")) << ours;
  const std::string command =
      absl::StrCat("promtool check metrics < ", folder_.File("scrape"), " 2>&1");
  FILE* const promtool = popen(command.c_str(), "r");
  ASSERT_NE(promtool, nullptr);
  std::string says(1 << 16, '\0');
  says.resize(fread(says.data(), 1, says.size(), promtool));
  EXPECT_EQ(pclose(promtool), 0);
  EXPECT_EQ(says, "");
}

}  // namespace
}  // namespace overtone
