// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_TESTS_SUPPORT_FAULT_TABLE_H_
#define OVERTONE_TESTS_SUPPORT_FAULT_TABLE_H_

#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <string>

namespace overtone {

// A row of the table of the fault tests: to standard output, and to the end of the file that
// OVERTONE_TEST_FAULT_TABLE names (tests/fault/run.sh prints it).
inline void FaultRow(const std::string& test, const std::string& what, const std::string& figure) {
  const std::string row = "| " + test + " | " + what + " | " + figure + " |\n";
  std::cout << row << std::flush;
  if (const char* path = std::getenv("OVERTONE_TEST_FAULT_TABLE")) {
    std::ofstream(path, std::ios::app) << row << std::flush;
  }
}

// A number that a longer run sets in the environment.
inline int64_t FromEnvironment(const char* name, int64_t otherwise) {
  const char* value = std::getenv(name);
  return value == nullptr ? otherwise : std::atoll(value);
}

}  // namespace overtone

#endif  // OVERTONE_TESTS_SUPPORT_FAULT_TABLE_H_
