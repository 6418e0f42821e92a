// SPDX-License-Identifier: Apache-2.0
// How log lines look: text for people, JSON for what collects logs.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_LOG_FORMAT_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_LOG_FORMAT_H_

#include <memory>
#include <string>

#include "spdlog/formatter.h"

namespace overtone {

// spdlog's own line, and the request it is about where that is known (log_fields.h):
//   [2026-11-24 12:00:00.123] [mapping_server] [info] map town: ... (request 7f3a...)
std::unique_ptr<spdlog::formatter> TextLines();

// One object a line, ASCII:
//   {"time":"2026-11-24T12:00:00.123456Z","level":"info","message":"map town: ...","map":"town"}
// with the fields "map", "robot", "mission" and "request_id" where they are known. What is not
// UTF-8 is replaced.
std::unique_ptr<spdlog::formatter> JsonLines();

// "text" or "json".
std::unique_ptr<spdlog::formatter> LogLines(const std::string& format);

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_LOG_FORMAT_H_
