// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_CLIENT_CLI_REPLAY_OPTIONS_H_
#define OVERTONE_CLIENT_CLI_REPLAY_OPTIONS_H_

#include <optional>
#include <string>
#include <vector>

#include "overtone/client/cli/client_flags.h"
#include "overtone/client/cli/dataset.h"
#include "overtone/client/cli/sensor_dataset.h"
#include "overtone/client/tls_files.h"

namespace overtone {

// As on the command line; replay_command.cc says what each means.
struct ReplayOptions {
  DatasetKind dataset = DatasetKind::kExample;
  std::string dataset_name = "example";
  std::vector<std::string> robots;      // NAME:odometry[:ground_truth]
  SensorDatasetFiles sensor_files;      // of mrclam, pcd, carmen, tuc
  std::vector<std::string> alignments;  // NAME:file
  int split = 1;
  double overlap = 0.2;
  std::string inject_drift;  // empty: none
  double example_duration_s = 600;

  std::string closures_from_ground_truth;  // empty: none
  std::string closures_file;               // empty: none
  std::string closure_tolerance;           // empty: the default

  std::optional<double> keyframe_distance_m;  // absent: the dataset's default
  std::optional<double> keyframe_rotation_rad;
  std::string odometry_sigma;

  std::string server;         // empty: one of our own
  TlsFiles tls;               // the operator's, for a server that is not our own
  std::string robot_certs;    // folder of the robots' certificates for it
  std::string server_config;  // of one of our own; empty: its defaults
  std::string map;            // empty: one of this run's own
  bool fresh = false;         // delete the map first
  std::string mission;        // of every robot; empty: "run"
  double speed = 0;           // data seconds per second; 0: as fast as possible
  double compare_every_s = 20;
  double reduction_percent = 0;
  double timeout_s = 300;
  std::string out = "run";
  ClientFlags client;

  std::string command_line;  // for the record
};

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_REPLAY_OPTIONS_H_
