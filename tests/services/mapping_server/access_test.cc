// SPDX-License-Identifier: Apache-2.0
// Every RPC that the server's schema has, called by every kind of peer for every map and mission.
// An RPC without a row in Rights() fails.
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "gmock/gmock.h"
#include "google/protobuf/dynamic_message.h"
#include "grpcpp/generic/generic_stub.h"
#include "gtest/gtest.h"
#include "overtone/tests/services/mapping_server/tls_fixture.h"

namespace overtone {
namespace {

using google::protobuf::DescriptorPool;
using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::MethodDescriptor;
using google::protobuf::ServiceDescriptor;
using testing::Connect;
using ::testing::ElementsAre;
using testing::TlsFolder;

// What a call needs.
enum class Right { kIdentity, kReadMap, kWriteMission, kAdministerMap, kBeOperator };

const std::map<std::string, Right>& Rights() {
  static const auto* const rights = new std::map<std::string, Right>{
      {"MappingService/GetServerInfo", Right::kIdentity},
      {"MappingService/UploadSubmaps", Right::kWriteMission},
      {"MappingService/GetUploadState", Right::kWriteMission},
      {"MappingService/AddLoopClosures", Right::kWriteMission},
      {"MappingService/WatchGraph", Right::kReadMap},
      {"MappingService/GetGraph", Right::kReadMap},
      {"MappingService/ReportStatus", Right::kWriteMission},
      {"MapAdminService/ListMaps", Right::kBeOperator},
      {"MapAdminService/ListRobots", Right::kAdministerMap},
      {"MapAdminService/ListMissions", Right::kAdministerMap},
      {"MapAdminService/ListLoopClosures", Right::kAdministerMap},
      {"MapAdminService/ExplainLoopClosures", Right::kAdministerMap},
      {"MapAdminService/VetoLoopClosure", Right::kAdministerMap},
      {"MapAdminService/ForceLoopClosure", Right::kAdministerMap},
      {"MapAdminService/ListRevisions", Right::kAdministerMap},
      {"MapAdminService/RollBack", Right::kAdministerMap},
      {"MapAdminService/GetTrajectory", Right::kAdministerMap},
      {"MapAdminService/GetStatusReport", Right::kAdministerMap},
      {"MapAdminService/GetConfiguration", Right::kBeOperator},
      {"MapAdminService/ExportMap", Right::kAdministerMap},
      {"MapAdminService/BackupMap", Right::kAdministerMap},
      {"MapAdminService/RestoreMap", Right::kAdministerMap},
      {"MapAdminService/VerifyMap", Right::kAdministerMap},
      {"MapAdminService/DeleteMission", Right::kAdministerMap},
      {"MapAdminService/DeleteMap", Right::kAdministerMap},
  };
  return *rights;
}

struct Peer {
  std::string who;  // as in the access file
  bool known;       // an identity, not revoked
  bool robot;
  std::string name;
  std::string map;  // the one that is granted
  CertificateAndKey certificate;
};

bool Allowed(Right right, const Peer& peer, const std::string& map, const std::string& robot) {
  if (!peer.known) return false;
  switch (right) {
    case Right::kIdentity:
      return true;
    case Right::kReadMap:
      return peer.map == map;
    case Right::kWriteMission:
      return peer.robot && peer.map == map && peer.name == robot;
    case Right::kAdministerMap:
      return !peer.robot && peer.map == map;
    case Right::kBeOperator:
      return !peer.robot;
  }
  return false;
}

// Sets every `map` and `robot` of a request, in the first frame of those that may come.
void Fill(const std::string& map, const std::string& robot, Message* message, int depth = 0) {
  const auto* reflection = message->GetReflection();
  for (int i = 0; i < message->GetDescriptor()->field_count(); ++i) {
    const FieldDescriptor* field = message->GetDescriptor()->field(i);
    const bool first_frame =
        field->containing_oneof() == nullptr || field->containing_oneof()->field(0) == field;
    if (field->type() == FieldDescriptor::TYPE_STRING && !field->is_repeated()) {
      if (field->name() == "map") reflection->SetString(message, field, map);
      if (field->name() == "robot") reflection->SetString(message, field, robot);
      if (field->name() == "mission") reflection->SetString(message, field, "run1");
    } else if (field->type() == FieldDescriptor::TYPE_MESSAGE && first_frame && depth < 4) {
      Fill(map, robot,
           field->is_repeated() ? reflection->AddMessage(message, field)
                                : reflection->MutableMessage(message, field),
           depth + 1);
    }
  }
}

// One request, whatever kind of method: ok also means that an answer came.
grpc::Status Call(grpc::GenericStub& stub, const std::string& method, const std::string& request) {
  grpc::ClientContext context;
  context.set_deadline(testing::Deadline());
  grpc::CompletionQueue queue;
  const auto await = [&queue] {
    void* tag = nullptr;
    bool ok = false;
    queue.Next(&tag, &ok);
    return ok;
  };
  auto stream = stub.PrepareCall(&context, method, &queue);
  stream->StartCall(nullptr);
  if (await()) {
    const grpc::Slice slice(request);
    stream->Write(grpc::ByteBuffer(&slice, 1), nullptr);
    await();
    grpc::ByteBuffer answer;
    stream->Read(&answer, nullptr);
    if (await()) {
      context.TryCancel();  // a stream may have no end
      grpc::Status ignored;
      stream->Finish(&ignored, nullptr);
      await();
      return grpc::Status::OK;
    }
  }
  grpc::Status status;
  stream->Finish(&status, nullptr);
  await();
  return status;
}

bool IsRefused(const grpc::Status& status) {
  return status.error_code() == grpc::StatusCode::UNAUTHENTICATED ||
         status.error_code() == grpc::StatusCode::PERMISSION_DENIED;
}

std::vector<const MethodDescriptor*> Methods() {
  std::vector<const MethodDescriptor*> methods;
  for (const char* name : {"overtone.v1.MappingService", "overtone.v1.MapAdminService"}) {
    const ServiceDescriptor* service = DescriptorPool::generated_pool()->FindServiceByName(name);
    EXPECT_NE(service, nullptr) << name;
    for (int i = 0; service != nullptr && i < service->method_count(); ++i) {
      methods.push_back(service->method(i));
    }
  }
  return methods;
}

std::string PathOf(const MethodDescriptor& method) {
  return absl::StrCat("/", method.service()->full_name(), "/", method.name());
}

std::string Request(const MethodDescriptor& method, const std::string& map,
                    const std::string& robot) {
  google::protobuf::DynamicMessageFactory factory;
  const std::unique_ptr<Message> request(factory.GetPrototype(method.input_type())->New());
  Fill(map, robot, request.get());
  return request->SerializeAsString();
}

class AccessTest : public ::testing::Test {
 protected:
  AccessTest()
      : folder_(
            "maps:\n"
            "  town: {robots: [anna, bert, revoked], operators: [olga]}\n"
            "  park: {robots: [carl], operators: [emil]}\n"
            "revoked: [robot/revoked]\n") {
    const testing::TestAuthority& ca = folder_.ca;
    peers_ = {
        {"robot/anna", true, true, "anna", "town", ca.Robot("anna")},
        {"robot/bert", true, true, "bert", "town", ca.Robot("bert")},
        {"robot/carl", true, true, "carl", "park", ca.Robot("carl")},
        {"robot/dora, granted nothing", true, true, "dora", "", ca.Robot("dora")},
        {"operator/olga", true, false, "olga", "town", ca.Operator("olga")},
        {"operator/emil", true, false, "emil", "park", ca.Operator("emil")},
        // A role is not a name.
        {"operator/anna", true, false, "anna", "", ca.Operator("anna")},
        {"no identity", false, true, "", "", ca.Peer({"https://test/robot/anna"})},
        {"two identities", false, true, "", "",
         ca.Peer({"spiffe://test/robot/anna", "spiffe://test/operator/olga"})},
        {"DNS name without the option", false, true, "", "", ca.Peer({}, {"anna.robot.test"})},
        {"revoked", false, true, "", "", ca.Robot("revoked")},
    };
    auto server = MappingServer::Start(folder_.Options());
    EXPECT_TRUE(server.ok()) << server.status();
    server_ = *std::move(server);
    // Maps that are there; their graphs and lists then answer something.
    for (const Peer& peer : peers_) {
      if (peer.robot && !peer.map.empty()) UploadOne(peer);
    }
  }

  void UploadOne(const Peer& peer) {
    const auto stub = v1::MappingService::NewStub(Channel(peer));
    testing::Uploader uploader(*stub, peer.map, {peer.name, "run1"});
    ASSERT_TRUE(uploader.Read().has_ready());
    ASSERT_TRUE(uploader.Send(testing::MakeSubmap(0, 0, 3)).has_ack());
    EXPECT_TRUE(uploader.Close().ok());
  }

  std::shared_ptr<grpc::Channel> Channel(const Peer& peer) {
    return Connect(server_->address(), folder_.ca.ca_pem(), peer.certificate);
  }

  TlsFolder folder_;
  std::vector<Peer> peers_;
  std::unique_ptr<MappingServer> server_;
};

TEST_F(AccessTest, EveryRpcHasARowAndEveryRowAnRpc) {
  std::vector<std::string> methods;
  for (const MethodDescriptor* method : Methods()) {
    methods.push_back(absl::StrCat(method->service()->name(), "/", method->name()));
    EXPECT_EQ(Rights().count(methods.back()), 1)
        << "what right does " << methods.back() << " need? Add it to Rights().";
  }
  EXPECT_EQ(methods.size(), Rights().size());
}

TEST_F(AccessTest, EveryRpcIsOpenToThoseWithTheRightAndToNobodyElse) {
  int calls = 0;
  for (const Peer& peer : peers_) {
    grpc::GenericStub stub(Channel(peer));
    for (const MethodDescriptor* method : Methods()) {
      const auto right =
          Rights().find(absl::StrCat(method->service()->name(), "/", method->name()));
      if (right == Rights().end()) continue;  // the test above fails
      for (const std::string map : {"town", "park", "nowhere"}) {
        for (const std::string robot : {"anna", "bert", "carl"}) {
          const grpc::Status status = Call(stub, PathOf(*method), Request(*method, map, robot));
          const std::string what = absl::StrCat(peer.who, " calls ", right->first, " for ", map,
                                                ", ", robot, ": ", status.error_message());
          EXPECT_NE(status.error_code(), grpc::StatusCode::UNAVAILABLE) << what;
          EXPECT_NE(status.error_code(), grpc::StatusCode::DEADLINE_EXCEEDED) << what;
          EXPECT_EQ(!IsRefused(status), Allowed(right->second, peer, map, robot)) << what;
          if (!peer.known) {
            EXPECT_EQ(status.error_code(), grpc::StatusCode::UNAUTHENTICATED) << what;
          } else if (IsRefused(status)) {
            EXPECT_EQ(status.error_code(), grpc::StatusCode::PERMISSION_DENIED) << what;
          }
          ++calls;
        }
      }
    }
  }
  std::cout << calls << " calls: " << Methods().size() << " RPCs, " << peers_.size()
            << " peers, 3 maps, 3 missions\n";
}

TEST_F(AccessTest, ARefusalDoesNotTellWhetherTheMapExists) {
  for (const Peer& peer : peers_) {
    grpc::GenericStub stub(Channel(peer));
    for (const MethodDescriptor* method : Methods()) {
      const auto ask = [&](const std::string& map) {
        return Call(stub, PathOf(*method), Request(*method, map, peer.name));
      };
      const std::string there = peer.map == "town" ? "park" : "town";
      const grpc::Status status = ask(there);
      if (!IsRefused(status)) continue;
      const grpc::Status nowhere = ask("nowhere");
      EXPECT_EQ(status.error_code(), nowhere.error_code()) << method->name();
      EXPECT_EQ(absl::StrReplaceAll(status.error_message(), {{there, "nowhere"}}),
                nowhere.error_message())
          << method->name();
    }
  }
}

TEST_F(AccessTest, AMissionThatIsNotOursIsNamedByItsField) {
  grpc::GenericStub stub(Channel(peers_[0]));  // anna
  const std::map<std::string, std::string> prefixes = {
      {"UploadSubmaps", "header.mission.robot: "},
      {"GetUploadState", "mission.robot: "},
      {"ReportStatus", "mission.robot: "},
      {"AddLoopClosures", "loop_closures[0]: "},
  };
  for (const MethodDescriptor* method : Methods()) {
    const auto prefix = prefixes.find(method->name());
    if (prefix == prefixes.end()) continue;
    const grpc::Status status = Call(stub, PathOf(*method), Request(*method, "town", "bert"));
    EXPECT_EQ(status.error_code(), grpc::StatusCode::PERMISSION_DENIED) << method->name();
    EXPECT_THAT(status.error_message(), ::testing::StartsWith(prefix->second));
  }
}

TEST_F(AccessTest, OneEndOfAClosureOfOursIsEnough) {
  const auto stub = v1::MappingService::NewStub(Channel(peers_[0]));  // anna
  v1::AddLoopClosuresRequest request;
  request.set_map("town");
  *request.add_loop_closures() =
      ToProto(testing::MakeClosure({{"bert", "run1"}, 0}, {{"anna", "run1"}, 1}));
  v1::AddLoopClosuresResponse response;
  grpc::ClientContext context;
  const grpc::Status status = stub->AddLoopClosures(&context, request, &response);
  EXPECT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(response.added(), 1);
}

TEST_F(AccessTest, AnOperatorSeesTheGrantedMapsOnly) {
  for (const Peer& peer : peers_) {
    if (!peer.known || peer.robot) continue;
    const auto stub = v1::MapAdminService::NewStub(Channel(peer));
    v1::ListMapsResponse response;
    grpc::ClientContext context;
    ASSERT_TRUE(stub->ListMaps(&context, {}, &response).ok());
    std::string maps;
    for (const v1::MapSummary& map : response.maps()) absl::StrAppend(&maps, map.map());
    EXPECT_EQ(maps, peer.map) << peer.who;
  }
}

TEST_F(AccessTest, HealthAndReflectionAreForWhoeverHasAnIdentity) {
  for (const Peer& peer : peers_) {
    grpc::GenericStub stub(Channel(peer));
    const std::string list_services("\x3a\x01*", 3);
    for (const auto& [method, request] : std::map<std::string, std::string>{
             {"/grpc.health.v1.Health/Check", ""},
             {"/grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo", list_services}}) {
      const grpc::Status status = Call(stub, method, request);
      EXPECT_EQ(status.error_code(),
                peer.known ? grpc::StatusCode::OK : grpc::StatusCode::UNAUTHENTICATED)
          << peer.who << " " << method << ": " << status.error_message();
    }
  }
}

TEST(PlaintextAccess, OnLoopbackEverybodyMayDoEverything) {
  auto server = MappingServer::Start(testing::TestOptions());
  ASSERT_TRUE(server.ok()) << server.status();
  grpc::GenericStub stub(
      grpc::CreateChannel((*server)->address(), grpc::InsecureChannelCredentials()));
  for (const MethodDescriptor* method : Methods()) {
    const grpc::Status status = Call(stub, PathOf(*method), Request(*method, "town", "anna"));
    EXPECT_FALSE(IsRefused(status)) << method->name() << ": " << status.error_message();
    EXPECT_NE(status.error_code(), grpc::StatusCode::UNAVAILABLE) << method->name();
  }
}

TEST(PlaintextAccess, AServerThatOthersCanReachDoesNotStart) {
  ServerOptions options = testing::TestOptions();
  options.listen = "0.0.0.0:0";
  EXPECT_EQ(MappingServer::Start(options).status().code(), absl::StatusCode::kInvalidArgument);
  options.security.insecure = true;
  EXPECT_TRUE(MappingServer::Start(options).ok());
}

}  // namespace
}  // namespace overtone
