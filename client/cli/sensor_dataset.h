// SPDX-License-Identifier: Apache-2.0
// Datasets that come as folders or logs, with what the robots' sensors saw.
#ifndef OVERTONE_CLIENT_CLI_SENSOR_DATASET_H_
#define OVERTONE_CLIENT_CLI_SENSOR_DATASET_H_

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "overtone/client/cli/dataset.h"

namespace overtone {

// mrclam, pcd, carmen, tuc.
bool IsSensorDataset(DatasetKind kind);

struct SensorDatasetFiles {
  std::vector<std::string> paths;  // folders, or the raw log; several for pcd only
  std::string reference;           // carmen: corrected log; empty: none
  std::string relations;           // carmen; empty: none
  double min_candidate_score = 0;  // tuc
};

// InvalidArgument: no path or too many, or a file as the dataset's own reader says; two robots of
// one name.
absl::StatusOr<std::vector<Recording>> ReadSensorDataset(DatasetKind kind,
                                                         const SensorDatasetFiles& files);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_SENSOR_DATASET_H_
