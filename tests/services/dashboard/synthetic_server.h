// SPDX-License-Identifier: Apache-2.0
// A server of the public API that serves a SyntheticMap, or answers as an older one would, or not
// at all.
#ifndef OVERTONE_TESTS_SERVICES_DASHBOARD_SYNTHETIC_SERVER_H_
#define OVERTONE_TESTS_SERVICES_DASHBOARD_SYNTHETIC_SERVER_H_

#include <atomic>
#include <memory>
#include <string>

#include "absl/base/thread_annotations.h"
#include "absl/strings/str_cat.h"
#include "absl/synchronization/mutex.h"
#include "grpcpp/grpcpp.h"
#include "overtone/tests/services/dashboard/synthetic_map.h"
#include "overtone/v1/map_admin_service.grpc.pb.h"
#include "overtone/v1/mapping_service.grpc.pb.h"

namespace overtone::testing {

class SyntheticServer final : public v1::MapAdminService::Service {
 public:
  explicit SyntheticServer(const SyntheticMapOptions& options, int port = 0) : map_(options) {
    grpc::ServerBuilder builder;
    builder.AddListeningPort(absl::StrCat("localhost:", port), grpc::InsecureServerCredentials(),
                             &port_);
    builder.RegisterService(static_cast<v1::MapAdminService::Service*>(this));
    builder.RegisterService(&info_);
    builder.SetMaxSendMessageSize(-1);
    server_ = builder.BuildAndStart();
  }
  ~SyntheticServer() override { server_->Shutdown(); }

  int port() const { return port_; }
  std::string address() const { return absl::StrCat("localhost:", port_); }
  void Advance() {
    absl::MutexLock lock(&mutex_);
    map_.Advance();
  }
  // Knows no reports, no odometry and no PLY.
  void ActOld() { old_ = true; }
  // Every call is refused so; OK: none is.
  void Refuse(grpc::StatusCode code) { refusal_ = code; }
  int trajectories_asked() const { return trajectories_asked_; }
  int clouds_asked() const { return clouds_asked_; }

  grpc::Status ListMaps(grpc::ServerContext*, const v1::ListMapsRequest*,
                        v1::ListMapsResponse* response) override {
    return Answer([&] { *response->add_maps() = map_.Summary("default"); });
  }
  grpc::Status ListRobots(grpc::ServerContext*, const v1::ListRobotsRequest*,
                          v1::ListRobotsResponse* response) override {
    return Answer([&] {
      for (v1::Robot& robot : map_.Robots()) {
        if (old_) robot.clear_report();
        *response->add_robots() = robot;
      }
    });
  }
  grpc::Status ListMissions(grpc::ServerContext*, const v1::ListMissionsRequest*,
                            v1::ListMissionsResponse* response) override {
    return Answer([&] {
      for (const v1::Mission& mission : map_.Missions()) *response->add_missions() = mission;
    });
  }
  // Pages of the size asked for, as a real server's.
  grpc::Status ListLoopClosures(grpc::ServerContext*, const v1::ListLoopClosuresRequest* request,
                                v1::ListLoopClosuresResponse* response) override {
    return Answer([&] {
      const size_t begin = request->page_token().empty() ? 0 : std::stoul(request->page_token());
      const size_t end = std::min(begin + request->page_size(), map_.closures().size());
      for (size_t i = begin; i < end; ++i) *response->add_loop_closures() = map_.closures()[i];
      if (end < map_.closures().size()) response->set_next_page_token(absl::StrCat(end));
    });
  }
  grpc::Status ListRevisions(grpc::ServerContext*, const v1::ListRevisionsRequest*,
                             v1::ListRevisionsResponse* response) override {
    return Answer([&] {
      for (const v1::Revision& revision : map_.revisions()) *response->add_revisions() = revision;
    });
  }
  grpc::Status GetTrajectory(grpc::ServerContext*, const v1::GetTrajectoryRequest* request,
                             v1::GetTrajectoryResponse* response) override {
    ++trajectories_asked_;
    bool found = false;
    const grpc::Status status = Answer([&] {
      found = map_.Trajectory(request->mission(), request->odometry() && !old_, *response);
    });
    return !status.ok() || found ? status
                                 : grpc::Status(grpc::StatusCode::NOT_FOUND, "mission: none");
  }
  grpc::Status GetStatusReport(grpc::ServerContext*, const v1::GetStatusReportRequest* request,
                               v1::GetStatusReportResponse* response) override {
    if (old_) return grpc::Status(grpc::StatusCode::UNIMPLEMENTED, "");
    return Answer([&] { map_.Report(request->mission(), *response->mutable_report()); });
  }
  grpc::Status VetoLoopClosure(grpc::ServerContext*, const v1::VetoLoopClosureRequest* request,
                               v1::VetoLoopClosureResponse*) override {
    bool found = false;
    const grpc::Status status = Answer([&] { found = map_.Veto(request->id()); });
    return !status.ok() || found ? status
                                 : grpc::Status(grpc::StatusCode::NOT_FOUND, "id: no such closure");
  }
  grpc::Status ExportMap(grpc::ServerContext*, const v1::ExportMapRequest* request,
                         grpc::ServerWriter<v1::ExportMapResponse>* writer) override {
    ++clouds_asked_;
    if (old_) return grpc::Status(grpc::StatusCode::INVALID_ARGUMENT, "format: 5 is none");
    std::string file;
    const grpc::Status status =
        Answer([&] { file = map_.Ply(request->voxel_m(), request->max_points()); });
    for (size_t at = 0; status.ok() && at < file.size(); at += 256 << 10) {
      v1::ExportMapResponse response;
      response.set_chunk(file.substr(at, 256 << 10));
      writer->Write(response);
    }
    return status;
  }

 private:
  class Info final : public v1::MappingService::Service {
    grpc::Status GetServerInfo(grpc::ServerContext*, const v1::GetServerInfoRequest*,
                               v1::GetServerInfoResponse* response) override {
      response->set_version("9.8.7");
      return grpc::Status::OK;
    }
  };

  template <typename Fill>
  grpc::Status Answer(Fill fill) {
    const grpc::StatusCode refusal = refusal_;
    if (refusal != grpc::StatusCode::OK) return grpc::Status(refusal, "not today");
    absl::MutexLock lock(&mutex_);
    fill();
    return grpc::Status::OK;
  }

  absl::Mutex mutex_;
  SyntheticMap map_ ABSL_GUARDED_BY(mutex_);
  std::atomic<bool> old_{false};
  std::atomic<grpc::StatusCode> refusal_{grpc::StatusCode::OK};
  std::atomic<int> trajectories_asked_{0};
  std::atomic<int> clouds_asked_{0};
  Info info_;
  int port_ = 0;
  std::unique_ptr<grpc::Server> server_;
};

}  // namespace overtone::testing

#endif  // OVERTONE_TESTS_SERVICES_DASHBOARD_SYNTHETIC_SERVER_H_
