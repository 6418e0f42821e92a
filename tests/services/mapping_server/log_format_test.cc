// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/log_format.h"

#include <memory>
#include <sstream>
#include <string>
#include <thread>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "nlohmann/json.hpp"
#include "overtone/services/mapping_server/log_fields.h"
#include "spdlog/logger.h"
#include "spdlog/sinks/ostream_sink.h"

namespace overtone {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::MatchesRegex;
using ::testing::Not;

class LogFormatTest : public ::testing::Test {
 protected:
  // The one line that `message` becomes.
  std::string Line(const std::string& format, const std::string& message) {
    std::ostringstream out;
    spdlog::logger logger("test", std::make_shared<spdlog::sinks::ostream_sink_mt>(out));
    logger.set_formatter(LogLines(format));
    logger.warn("{}", message);
    return out.str();
  }
  nlohmann::json Object(const std::string& message) {
    const std::string line = Line("json", message);
    EXPECT_EQ(line.find('\n'), line.size() - 1);
    return nlohmann::json::parse(line);
  }
};

TEST_F(LogFormatTest, TextIsForPeople) {
  EXPECT_THAT(Line("text", "map town: all is well"),
              MatchesRegex("\\[2[-0-9]* [.:0-9]*\\] \\[test\\] \\[warning\\] "
                           "map town: all is well\n"));
}

TEST_F(LogFormatTest, JsonHasTimeLevelAndMessage) {
  const nlohmann::json line = Object("map town: all is well");
  EXPECT_EQ(line.size(), 3u);
  EXPECT_EQ(line["level"], "warning");
  EXPECT_EQ(line["message"], "map town: all is well");
  EXPECT_THAT(line["time"].get<std::string>(),
              MatchesRegex("2[0-9]*-[0-9]*-[0-9]*T[0-9]*:[0-9]*:[0-9]*\\.[0-9]*Z"));
}

TEST_F(LogFormatTest, WhateverTheMessageHoldsItIsOneLineOfAscii) {
  for (const std::string nasty : {"two\nlines \"quoted\" \\ \x01 tab\t", "gr\xc3\xbc\xc3\x9f",
                                  "not UTF-8: \xff\xfe\x80", "a\0b"}) {
    const std::string line = Line("json", nasty);
    for (const char c : line.substr(0, line.size() - 1)) {
      EXPECT_TRUE(c >= 0x20 && c < 0x7f) << line;
    }
  }
  EXPECT_EQ(Object("gr\xc3\xbc\xc3\x9f")["message"], "gr\xc3\xbc\xc3\x9f");
  EXPECT_EQ(Object("two\nlines")["message"], "two\nlines");
}

TEST_F(LogFormatTest, TheScopesFieldsAreInTheLine) {
  const LogFields upload = {"town", "anna", "run1", "7f3a"};
  const LogFields map = {"park", "", "", ""};
  {
    const LogScope outer(&upload);
    const nlohmann::json line = Object("x");
    EXPECT_EQ(line["map"], "town");
    EXPECT_EQ(line["robot"], "anna");
    EXPECT_EQ(line["mission"], "run1");
    EXPECT_EQ(line["request_id"], "7f3a");
    EXPECT_THAT(Line("text", "x"), EndsWith("] x (request 7f3a)\n"));
    {
      const LogScope inner(&map);
      EXPECT_EQ(Object("x")["map"], "park");
      EXPECT_FALSE(Object("x").contains("robot"));
      EXPECT_THAT(Line("text", "x"), Not(HasSubstr("request")));
    }
    EXPECT_EQ(Object("x")["map"], "town");
    // Another thread's lines are about something else.
    std::thread([&] { EXPECT_EQ(Object("x").size(), 3u); }).join();
  }
  EXPECT_EQ(Object("x").size(), 3u);
}

}  // namespace
}  // namespace overtone
