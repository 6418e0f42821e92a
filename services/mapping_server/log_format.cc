// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/log_format.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/time.h"
#include "nlohmann/json.hpp"
#include "overtone/services/mapping_server/log_fields.h"
#include "spdlog/pattern_formatter.h"

namespace overtone {
namespace {

// " (request 7f3a...)", or nothing.
class RequestFlag final : public spdlog::custom_flag_formatter {
 public:
  void format(const spdlog::details::log_msg&, const std::tm&,
              spdlog::memory_buf_t& line) override {
    const LogFields* const fields = LogScope::Fields();
    if (fields == nullptr || fields->request_id.empty()) return;
    const std::string text = absl::StrCat(" (request ", fields->request_id, ")");
    line.append(text.data(), text.data() + text.size());
  }
  std::unique_ptr<custom_flag_formatter> clone() const override {
    return std::make_unique<RequestFlag>();
  }
};

class JsonFormatter final : public spdlog::formatter {
 public:
  void format(const spdlog::details::log_msg& message, spdlog::memory_buf_t& line) override {
    nlohmann::ordered_json object;
    object["time"] = absl::FormatTime("%Y-%m-%d%ET%H:%M:%E6SZ", absl::FromChrono(message.time),
                                      absl::UTCTimeZone());
    const auto level = spdlog::level::to_string_view(message.level);
    object["level"] = std::string(level.data(), level.size());
    object["message"] = std::string(message.payload.data(), message.payload.size());
    AddFields(object);
    const std::string text =
        object.dump(-1, ' ', /*ensure_ascii=*/true, nlohmann::json::error_handler_t::replace);
    line.append(text.data(), text.data() + text.size());
    line.push_back('\n');
  }
  std::unique_ptr<formatter> clone() const override { return std::make_unique<JsonFormatter>(); }

 private:
  static void AddFields(nlohmann::ordered_json& object) {
    const LogFields* const fields = LogScope::Fields();
    if (fields == nullptr) return;
    const std::pair<const char*, const std::string*> named[] = {
        {"map", &fields->map},
        {"robot", &fields->robot},
        {"mission", &fields->mission},
        {"request_id", &fields->request_id}};
    for (const auto& [name, value] : named) {
      if (!value->empty()) object[name] = *value;
    }
  }
};

}  // namespace

std::unique_ptr<spdlog::formatter> TextLines() {
  auto formatter = std::make_unique<spdlog::pattern_formatter>();
  formatter->add_flag<RequestFlag>('*').set_pattern("%+%*");
  return formatter;
}

std::unique_ptr<spdlog::formatter> JsonLines() { return std::make_unique<JsonFormatter>(); }

std::unique_ptr<spdlog::formatter> LogLines(const std::string& format) {
  return format == "json" ? JsonLines() : TextLines();
}

}  // namespace overtone
