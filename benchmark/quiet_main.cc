// SPDX-License-Identifier: Apache-2.0
// Of the benchmarks that start a server in their own process: its log would be among the results.
#include "benchmark/benchmark.h"
#include "spdlog/spdlog.h"

int main(int argc, char** argv) {
  spdlog::set_level(spdlog::level::err);
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
