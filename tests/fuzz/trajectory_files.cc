// SPDX-License-Identifier: Apache-2.0
// TUM, EuRoC and KITTI: what is read can be written, and reads back as it was.
#include <sstream>

#include "overtone/core/geometry/trajectory_io.h"
#include "overtone/tests/fuzz/fuzz_input.h"

namespace overtone::fuzz {
namespace {

TrajectoryFormat FormatOf(uint8_t selector) {
  switch (selector) {
    case 'e':
      return TrajectoryFormat::kEuroc;
    case 'k':
      return TrajectoryFormat::kKitti;
    default:
      return TrajectoryFormat::kTum;
  }
}

void Run(absl::string_view input) {
  const TrajectoryFormat format = FormatOf(TakeSelector(input));
  std::istringstream in{std::string(input)};
  const absl::StatusOr<Trajectory> trajectory = ReadTrajectory(in, "fuzz", format);
  if (!trajectory.ok()) return;
  std::stringstream file;
  WriteTrajectory(file, format, *trajectory);
  const absl::StatusOr<Trajectory> again = ReadTrajectory(file, "written", format);
  FUZZ_CHECK(again.ok(), again.status().ToString());
  FUZZ_CHECK(again->size() == trajectory->size(), "rows are lost");
  for (size_t i = 0; i < trajectory->size(); ++i) {
    FUZZ_CHECK((*again)[i].stamp == (*trajectory)[i].stamp, "a stamp changed");
    FUZZ_CHECK((*again)[i].pose.translation == (*trajectory)[i].pose.translation,
               "a position changed");
  }
}

}  // namespace
}  // namespace overtone::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  overtone::fuzz::Run(overtone::fuzz::AsText(data, size));
  return 0;
}
