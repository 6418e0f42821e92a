// SPDX-License-Identifier: Apache-2.0
// What a Prometheus server would read, over a plain socket.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <string>

#include "absl/strings/str_cat.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/tests/services/mapping_server/server_fixture.h"

namespace overtone {
namespace {

using ::testing::HasSubstr;
using testing::MakeClosure;
using testing::MakeSubmap;
using ::testing::Not;
using ::testing::StartsWith;
using testing::TestOptions;
using testing::Uploader;

const MissionId kAnna = {"anna", "run1"};

std::string Get(int port, const std::string& path) {
  const int connection = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address = {};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  EXPECT_EQ(connect(connection, reinterpret_cast<sockaddr*>(&address), sizeof(address)), 0);
  const std::string request = "GET " + path + " HTTP/1.0\r\n\r\n";
  EXPECT_EQ(send(connection, request.data(), request.size(), MSG_NOSIGNAL),
            static_cast<ssize_t>(request.size()));
  std::string answer(1 << 20, '\0');
  size_t size = 0;
  for (ssize_t n = 1; n > 0 && size<answer.size(); size += n> 0 ? n : 0) {
    n = recv(connection, &answer[size], answer.size() - size, 0);
  }
  close(connection);
  answer.resize(size);
  return answer;
}

class MetricsTest : public testing::ServerTest {
 protected:
  void SetUp() override {
    ServerOptions options = TestOptions();
    options.metrics_listen = "127.0.0.1:0";
    StartServer(options);
  }
};

TEST_F(MetricsTest, EveryMapTellsOfItsNewestRevision) {
  {
    Uploader uploader(*mapping_, "mine", kAnna);
    ASSERT_TRUE(uploader.Read().has_ready());
    Submap submap = MakeSubmap(0, 0, 20);
    LoopClosure closure = MakeClosure({kAnna, 15}, {kAnna, 3});
    closure.from_tform_to =
        submap.keyframes[15].mission_from_body.Inverse() * submap.keyframes[3].mission_from_body;
    submap.loop_closures.push_back(closure);
    submap.loop_closures.push_back(MakeClosure({kAnna, 12}, {{"carl", "run1"}, 3}));
    ASSERT_TRUE(uploader.Send(submap).has_ack());
    EXPECT_TRUE(uploader.Close().ok());
  }
  Upload("yours", kAnna, 1, 7);
  Settle("mine");
  Settle("yours");
  const std::string answer = Get(server_->metrics_port(), "/metrics");
  EXPECT_THAT(answer, HasSubstr("200 OK"));
  for (const char* line : {
           "# TYPE overtone_loop_closures gauge",
           "overtone_loop_closures{map=\"mine\",verdict=\"accepted\"} 1\n",
           "overtone_loop_closures{map=\"mine\",verdict=\"pending\"} 1\n",
           "overtone_loop_closures{map=\"mine\",verdict=\"vetoed_by_operator\"} 0\n",
           "overtone_loop_closures{map=\"yours\",verdict=\"accepted\"} 0\n",
           "overtone_keyframes{map=\"mine\"} 20\n",
           "overtone_keyframes{map=\"yours\"} 7\n",
           "overtone_missions{map=\"mine\",anchored=\"true\"} 1\n",
           "overtone_missions{map=\"mine\",anchored=\"false\"} 0\n",
           "overtone_revision{map=\"yours\"} 1\n",
           "overtone_front_end_backlog{map=\"mine\"} 0\n",
           "overtone_revision_age_seconds{map=\"mine\"}",
           "overtone_optimisation_seconds{map=\"mine\"}",
       }) {
    EXPECT_THAT(answer, HasSubstr(line));
  }
}

TEST_F(MetricsTest, WithoutMapsThereIsNothingToTell) {
  const std::string answer = Get(server_->metrics_port(), "/metrics");
  EXPECT_THAT(answer, HasSubstr("200 OK"));
  EXPECT_THAT(answer, Not(HasSubstr("{map=")));
}

TEST_F(MetricsTest, AnAddressThatCannotBeListenedOnIsNamed) {
  const struct {
    std::string listen;
    absl::StatusCode code;
  } cases[] = {
      {"nonsense", absl::StatusCode::kInvalidArgument},
      {"127.0.0.1:99999", absl::StatusCode::kInvalidArgument},
      {"192.0.2.1:80", absl::StatusCode::kUnavailable},  // of no host, RFC 5737
      {absl::StrCat("127.0.0.1:", server_->metrics_port()), absl::StatusCode::kUnavailable},
  };
  for (const auto& bad : cases) {
    ServerOptions options = TestOptions();
    options.metrics_listen = bad.listen;
    const auto server = MappingServer::Start(options);
    EXPECT_EQ(server.status().code(), bad.code) << bad.listen;
    EXPECT_THAT(std::string(server.status().message()), StartsWith("metrics_listen: "));
  }
}

TEST(WithoutMetrics, NoPortIsTaken) {
  const auto server = MappingServer::Start(TestOptions());
  ASSERT_TRUE(server.ok()) << server.status();
  EXPECT_EQ((*server)->metrics_port(), 0);
}

}  // namespace
}  // namespace overtone
