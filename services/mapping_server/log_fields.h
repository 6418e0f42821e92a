// SPDX-License-Identifier: Apache-2.0
// What a log line is about, for those who search by it.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_LOG_FIELDS_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_LOG_FIELDS_H_

#include <string>
#include <utility>

namespace overtone {

// Empty: not known.
struct LogFields {
  std::string map;
  std::string robot;
  std::string mission;
  std::string request_id;
};

// Of what a peer sent: names that are no ids are left out, whatever they hold.
LogFields LogFieldsOf(const std::string& map, const std::string& robot = "",
                      const std::string& mission = "");

// While it lives, every line that this thread logs is about `fields`, which outlive it. Scopes
// nest: the innermost counts.
class LogScope {
 public:
  explicit LogScope(const LogFields* fields) : outer_(std::exchange(Current(), fields)) {}
  ~LogScope() { Current() = outer_; }
  LogScope(const LogScope&) = delete;
  LogScope& operator=(const LogScope&) = delete;

  // Of this thread; null: nothing is known.
  static const LogFields* Fields() { return Current(); }

 private:
  static const LogFields*& Current() {
    thread_local const LogFields* current = nullptr;
    return current;
  }

  const LogFields* const outer_;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_LOG_FIELDS_H_
