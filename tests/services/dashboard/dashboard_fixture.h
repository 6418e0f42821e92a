// SPDX-License-Identifier: Apache-2.0
// A dashboard in this process before some server of the API, and an HTTP client before it.
#ifndef OVERTONE_TESTS_SERVICES_DASHBOARD_DASHBOARD_FIXTURE_H_
#define OVERTONE_TESTS_SERVICES_DASHBOARD_DASHBOARD_FIXTURE_H_

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "gtest/gtest.h"
#include "nlohmann/json.hpp"
#include "overtone/services/dashboard/dashboard_server.h"
#include "overtone/services/dashboard/http_library.h"
#include "overtone/tests/services/dashboard/decoded_frame.h"

namespace overtone::testing {

class Dashboard {
 public:
  static DashboardOptions Options(const std::string& server, const std::string& map = "default") {
    DashboardOptions options;
    options.connection.server = server;
    options.listen = "localhost:0";
    options.map = map;
    options.mirror.interval = absl::Milliseconds(50);
    return options;
  }

  explicit Dashboard(const DashboardOptions& options) {
    auto started = DashboardServer::Start(options);
    EXPECT_TRUE(started.ok()) << started.status();
    if (!started.ok()) return;
    server_ = *std::move(started);
    http_ = std::make_unique<httplib::Client>(server_->url());
  }

  DashboardServer& server() { return *server_; }
  httplib::Client& http() { return *http_; }

  // "GET path" must answer 200.
  std::string Get(const std::string& path) {
    const httplib::Result result = http_->Get(path);
    EXPECT_TRUE(result) << path;
    if (!result) return "";
    EXPECT_EQ(result->status, 200) << path << ": " << result->body;
    return result->body;
  }
  nlohmann::json Json(const std::string& path) {
    const auto parsed = nlohmann::json::parse(Get(path), nullptr, false);
    EXPECT_FALSE(parsed.is_discarded()) << path;
    return parsed;
  }
  DecodedFrame Frame(const std::string& path) { return DecodedFrame(Get(path)); }

  // The first state of which `is_wanted`; after half a minute the test fails.
  nlohmann::json WaitFor(const std::function<bool(const nlohmann::json& state)>& is_wanted) {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    nlohmann::json state;
    while (std::chrono::steady_clock::now() < deadline) {
      state = Json("/api/state");
      if (is_wanted(state)) return state;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));  // between two questions
    }
    ADD_FAILURE() << "never so: " << state.dump().substr(0, 2000);
    return state;
  }
  nlohmann::json WaitForRevision(uint64_t revision) {
    return WaitFor([revision](const nlohmann::json& state) {
      return state["link"]["ok"] && state["summary"]["revision"] >= revision;
    });
  }

  httplib::Result Veto(const std::string& id, httplib::Headers headers = OurPage()) {
    return http_->Post("/api/closures/veto", headers, nlohmann::json({{"id", id}}).dump(),
                       "application/json");
  }
  static httplib::Headers OurPage() { return {{"X-Overtone-Dashboard", "1"}}; }

 private:
  std::unique_ptr<DashboardServer> server_;
  std::unique_ptr<httplib::Client> http_;
};

}  // namespace overtone::testing

#endif  // OVERTONE_TESTS_SERVICES_DASHBOARD_DASHBOARD_FIXTURE_H_
