// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/observation_codec.h"

#include <array>

namespace overtone {
namespace {

Json VectorToJson(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

Eigen::Vector3d VectorFromJson(const Json& json) {
  const auto v = json.get<std::array<double, 3>>();
  return {v[0], v[1], v[2]};
}

Json PointCovarianceToJson(const Eigen::Matrix3d& c) {
  return {c(0, 0), c(0, 1), c(0, 2), c(1, 1), c(1, 2), c(2, 2)};
}

Eigen::Matrix3d PointCovarianceFromJson(const Json& json) {
  const auto v = json.get<std::array<double, 6>>();
  Eigen::Matrix3d covariance;
  covariance << v[0], v[1], v[2],  //
      v[1], v[3], v[4],            //
      v[2], v[4], v[5];
  return covariance;
}

template <typename Sighting>
Json SightingsToJson(const std::vector<Sighting>& sightings, const char* key,
                     std::string Sighting::*name) {
  Json json = Json::array();
  for (const Sighting& sighting : sightings) {
    json.push_back({{"index", sighting.index},
                    {key, sighting.*name},
                    {"point_in_body", VectorToJson(sighting.point_in_body)},
                    {"covariance", PointCovarianceToJson(sighting.covariance)}});
  }
  return json;
}

template <typename Sighting>
std::vector<Sighting> SightingsFromJson(const Json& json, const char* key) {
  std::vector<Sighting> sightings;
  for (const Json& row : json) {
    sightings.push_back({IntegerFromJson(row.at("index")), row.at(key).get<std::string>(),
                         VectorFromJson(row.at("point_in_body")),
                         PointCovarianceFromJson(row.at("covariance"))});
  }
  return sightings;
}

}  // namespace

Json ToJson(const Observations& observations) {
  Json clouds = Json::array(), poses = Json::array();
  for (const RecordedCloud& cloud : observations.clouds) {
    clouds.push_back({{"index", cloud.index}, {"file", cloud.path}});
  }
  for (const AbsolutePose& pose : observations.absolute_poses) {
    poses.push_back({{"index", pose.index},
                     {"map_tform_body", ToJson(pose.map_from_body)},
                     {"covariance", ToJson(pose.covariance)}});
  }
  return {{"clouds", clouds},
          {"landmark_sightings", SightingsToJson(observations.landmark_sightings, "landmark",
                                                 &LandmarkSighting::landmark)},
          {"robot_sightings",
           SightingsToJson(observations.robot_sightings, "robot", &RobotSighting::robot)},
          {"absolute_poses", poses}};
}

Json ToJson(const ScoredCandidate& candidate) {
  return {
      {"from", ToJson(candidate.from)}, {"to", ToJson(candidate.to)}, {"score", candidate.score}};
}

Observations ObservationsFromJson(const Json& json) {
  const Json none = Json::array();
  Observations observations;
  for (const Json& row : json.value("clouds", none)) {
    observations.clouds.push_back(
        {IntegerFromJson(row.at("index")), row.at("file").get<std::string>(), nullptr});
  }
  observations.landmark_sightings =
      SightingsFromJson<LandmarkSighting>(json.value("landmark_sightings", none), "landmark");
  observations.robot_sightings =
      SightingsFromJson<RobotSighting>(json.value("robot_sightings", none), "robot");
  for (const Json& row : json.value("absolute_poses", none)) {
    observations.absolute_poses.push_back({IntegerFromJson(row.at("index")),
                                           PoseFromJson(row.at("map_tform_body")),
                                           CovarianceFromJson(row.at("covariance"))});
  }
  return observations;
}

ScoredCandidate ScoredCandidateFromJson(const Json& json) {
  return {NodeIdFromJson(json.at("from")), NodeIdFromJson(json.at("to")),
          json.at("score").get<double>()};
}

}  // namespace overtone
