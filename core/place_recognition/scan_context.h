// SPDX-License-Identifier: Apache-2.0
// Scan Context: what a place looks like from above, in polar cells around the sensor, each with the
// height of the highest point in it. Kim & Kim, IROS 2018. Turning on the spot shifts its columns;
// the ring key, averages over all directions, does not change at all.
//
// Two things differ from the paper.
//  * Rings widen with their distance, as sectors do (log-polar), so that one setting serves
//    corridors and streets: a place moved sideways moves by the same share of a cell anywhere.
//  * A sector without any point was not seen: it is neither like nor unlike another one. This is
//    what makes limited sensors comparable (70 degrees, or a planar laser's 180).
// A planar laser's points all have one height; its cells say occupied or empty.
#ifndef OVERTONE_CORE_PLACE_RECOGNITION_SCAN_CONTEXT_H_
#define OVERTONE_CORE_PLACE_RECOGNITION_SCAN_CONTEXT_H_

#include "Eigen/Core"
#include "Eigen/Geometry"
#include "absl/status/status.h"
#include "overtone/core/graph/point_cloud.h"

namespace overtone {

struct ScanContextOptions {
  double min_range_m = 1;   // horizontal; nearer is the robot itself
  double max_range_m = 80;  // farther, points are too thin to come again
  int rings = 30;           // 15 % wider each than the one before; even
  int sectors = 60;         // 6 degrees
  // Sectors that both have seen, as a share of what the one that saw less has.
  double min_common_share = 0.5;

  absl::Status Validate() const;
};

struct ScanContext {
  // rings x sectors; the columns have length 1, or are zero where the sensor saw nothing. Column j
  // is the direction -pi + (j + 1/2) * 2 pi / sectors.
  Eigen::MatrixXf columns;
  Eigen::VectorXf seen;      // sectors; 1 where the column is not zero, else 0
  Eigen::VectorXf ring_key;  // rings / 2; mean of the seen columns, two rings added up each
};

struct ScanContextMatch {
  double similarity = 0;  // [0, 1]
  double yaw_rad = 0;     // heading of from_R_to, (-pi, pi]; translation is taken for small
};

// Turns the body frame upright and leaves its heading: z against gravity, x above body's x. Where
// mission frames stand upright, as those of lidar- and visual-inertial odometry do.
Eigen::Quaterniond LevelFromBody(const Eigen::Quaterniond& mission_from_body);

// O(points). `cloud` in the body frame; one without points in range sees nothing.
ScanContext ComputeScanContext(const PointCloud& cloud, const Eigen::Quaterniond& level_from_body,
                               const ScanContextOptions& options);

// Both of the same options. Mean cosine of the columns both have seen, at the best of all shifts,
// less where these are few: n columns count as n / (n + 6), relative to the most that could have
// been common. 1 between a scan that saw 60 degrees or more and itself; 0 when nothing was common.
// Symmetric. The yaw is refined below a sector's width by a parabola through the best shift's
// neighbours. O(rings * sectors^2): 108,000 multiplications.
ScanContextMatch CompareScanContexts(const ScanContext& from, const ScanContext& to,
                                     const ScanContextOptions& options);

// The rotation from_R_to between the bodies that a yaw between their upright frames stands for.
Eigen::Quaterniond BodyRotation(const Eigen::Quaterniond& level_from_from, double yaw_rad,
                                const Eigen::Quaterniond& level_from_to);

}  // namespace overtone

#endif  // OVERTONE_CORE_PLACE_RECOGNITION_SCAN_CONTEXT_H_
