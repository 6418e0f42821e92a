// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_CLIENT_INTERNAL_LOGGER_H_
#define OVERTONE_CLIENT_INTERNAL_LOGGER_H_

#include <functional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "overtone/client/mapping_client_options.h"

namespace overtone {

// Hands messages to the host's callback, if there is one, and swallows what that throws: there is
// nowhere left to report it.
class Logger {
 public:
  Logger() = default;
  explicit Logger(std::function<void(LogLevel, absl::string_view)> sink) : sink_(std::move(sink)) {}

  template <typename... Args>
  void Info(const Args&... args) const {
    Write(LogLevel::kInfo, args...);
  }
  template <typename... Args>
  void Warning(const Args&... args) const {
    Write(LogLevel::kWarning, args...);
  }
  template <typename... Args>
  void Error(const Args&... args) const {
    Write(LogLevel::kError, args...);
  }

 private:
  template <typename... Args>
  void Write(LogLevel level, const Args&... args) const {
    if (!sink_) return;
    try {
      sink_(level, absl::StrCat(args...));
    } catch (...) {
    }
  }

  std::function<void(LogLevel, absl::string_view)> sink_;
};

}  // namespace overtone

#endif  // OVERTONE_CLIENT_INTERNAL_LOGGER_H_
