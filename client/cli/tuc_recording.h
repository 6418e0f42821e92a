// SPDX-License-Identifier: Apache-2.0
// The TUC SLAM dataset: wheel odometry and visual place recognition that is at times mistaken.
// Neubert, Schubert & Protzel, IEEE RA-L 4(4), 2019; files as libRSF ships them.
#ifndef OVERTONE_CLIENT_CLI_TUC_RECORDING_H_
#define OVERTONE_CLIENT_CLI_TUC_RECORDING_H_

#include <string>

#include "absl/status/statusor.h"
#include "overtone/client/cli/dataset.h"

namespace overtone {

// The one NAME_Input.txt of a folder, named NAME:
//   odom2 t vx vy turn_rate var_vx var_vy var_turn   [s, m/s, rad/s]: integrated from the identity,
//                                                    a frame each
//   loop t1 t2 score                                 candidates between the frames nearest in time,
//                                                    those of at least `min_candidate_score`
// and the ground truth's positions (point2 t x y ...) of NAME_GT.txt where there is one. Other
// records are not read.
//
// NotFound: no such file, or several; InvalidArgument "file:line: what".
absl::StatusOr<Recording> ReadTucRecording(const std::string& folder, double min_candidate_score);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_TUC_RECORDING_H_
