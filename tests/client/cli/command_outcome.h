// SPDX-License-Identifier: Apache-2.0
// A subcommand as typed, and what it prints.
#ifndef OVERTONE_TESTS_CLIENT_CLI_COMMAND_OUTCOME_H_
#define OVERTONE_TESTS_CLIENT_CLI_COMMAND_OUTCOME_H_

#include <algorithm>
#include <functional>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include "CLI/CLI.hpp"

namespace overtone::testing {

struct Outcome {
  int exit_code = -1;
  std::string out, err;
};

// What a stream is told while this lives.
class Captured {
 public:
  explicit Captured(std::ostream* stream) : stream_(stream), before_(stream->rdbuf()) {
    stream_->rdbuf(text_.rdbuf());
  }
  ~Captured() { stream_->rdbuf(before_); }
  std::string text() const { return text_.str(); }

 private:
  std::ostream* stream_;
  std::streambuf* before_;
  std::ostringstream text_;
};

using AddCommands = void (*)(CLI::App* app, std::function<int()>* run);

// Throws CLI::ParseError as the program's main would see it.
inline Outcome RunCommand(const std::vector<AddCommands>& commands,
                          std::vector<std::string> arguments) {
  CLI::App app;
  std::function<int()> run;
  for (const AddCommands add : commands) add(&app, &run);
  std::reverse(arguments.begin(), arguments.end());  // as CLI11 wants them
  app.parse(arguments);
  Outcome outcome;
  const Captured out(&std::cout), err(&std::cerr);
  outcome.exit_code = run();
  outcome.out = out.text();
  outcome.err = err.text();
  return outcome;
}

}  // namespace overtone::testing

#endif  // OVERTONE_TESTS_CLIENT_CLI_COMMAND_OUTCOME_H_
