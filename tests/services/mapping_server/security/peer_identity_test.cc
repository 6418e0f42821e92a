// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/security/peer_identity.h"

#include <string>
#include <vector>

#include "gtest/gtest.h"

namespace overtone {
namespace {

struct Case {
  PeerNames names;
  std::string with_dns;     // identity, or empty: refused
  std::string without_dns;  // likewise
};

std::string Identity(const PeerNames& names, bool accept_dns_names) {
  const absl::StatusOr<PeerIdentity> identity = ParsePeerIdentity(names, accept_dns_names);
  if (identity.ok()) return ToString(*identity);
  EXPECT_EQ(identity.status().code(), absl::StatusCode::kUnauthenticated) << identity.status();
  return "";
}

TEST(PeerIdentity, IsWhatTheNamesSayAndNothingElse) {
  const Case cases[] = {
      {{{"spiffe://acme/robot/anna"}, {}}, "robot/anna", "robot/anna"},
      {{{"spiffe://acme.example.org/operator/olga"}, {}}, "operator/olga", "operator/olga"},
      {{{"SPIFFE://ACME/robot/anna"}, {}}, "robot/anna", "robot/anna"},
      // The names of services and hosts do not matter.
      {{{"https://acme/robot/bert", "spiffe://acme/robot/anna"}, {"map.acme"}},
       "robot/anna",
       "robot/anna"},
      {{{"spiffe://acme/robot/anna", "spiffe://other/robot/anna"}, {}}, "robot/anna", "robot/anna"},
      // Two identities are none.
      {{{"spiffe://acme/robot/anna", "spiffe://acme/robot/bert"}, {}}, "", ""},
      {{{"spiffe://acme/robot/anna", "spiffe://acme/operator/anna"}, {}}, "", ""},
      {{{"spiffe://acme/robot/anna"}, {"bert.robot.acme"}}, "", "robot/anna"},
      // Nearly one.
      {{{}, {}}, "", ""},
      {{{"spiffe:///robot/anna"}, {}}, "", ""},
      {{{"spiffe://acme/robot"}, {}}, "", ""},
      {{{"spiffe://acme/robot/"}, {}}, "", ""},
      {{{"spiffe://acme/robot/anna/x"}, {}}, "", ""},
      {{{"spiffe://acme/x/robot/anna"}, {}}, "", ""},
      {{{"spiffe://acme/robots/anna"}, {}}, "", ""},
      {{{"spiffe://acme/Robot/anna"}, {}}, "", ""},
      {{{"spiffe://acme/robot/Anna"}, {}}, "", ""},
      {{{"spiffe://acme/robot/*"}, {}}, "", ""},
      {{{"spiffe://acme/robot/" + std::string(64, 'a')}, {}}, "", ""},
      {{{"xspiffe://acme/robot/anna"}, {}}, "", ""},
      // DNS names, by option.
      {{{}, {"anna.robot.acme"}}, "robot/anna", ""},
      {{{}, {"Anna.ROBOT.Acme.example.org"}}, "robot/anna", ""},
      {{{}, {"olga.operator.acme"}}, "operator/olga", ""},
      {{{}, {"anna.robot"}}, "", ""},
      {{{}, {"anna.robot."}}, "", ""},
      {{{}, {"x.anna.robot.acme"}}, "", ""},
      {{{}, {"*.robot.acme"}}, "", ""},
      {{{}, {"anna.robot.acme", "bert.robot.acme"}}, "", ""},
  };
  for (const Case& a_case : cases) {
    std::string what;
    for (const std::string& name : a_case.names.uris) what += " " + name;
    for (const std::string& name : a_case.names.dns) what += " " + name;
    EXPECT_EQ(Identity(a_case.names, true), a_case.with_dns) << what;
    EXPECT_EQ(Identity(a_case.names, false), a_case.without_dns) << what;
  }
}

TEST(PeerIdentity, IsReadAsItIsWritten) {
  for (const char* text : {"robot/anna", "operator/olga-2"}) {
    const auto identity = ParseRoleAndName(text);
    ASSERT_TRUE(identity.has_value()) << text;
    EXPECT_EQ(ToString(*identity), text);
  }
  for (const char* text : {"", "robot", "robot/", "/anna", "robot/Anna", "robot/*", "robot/a/b",
                           "dog/anna", " robot/anna"}) {
    EXPECT_FALSE(ParseRoleAndName(text).has_value()) << text;
  }
}

}  // namespace
}  // namespace overtone
