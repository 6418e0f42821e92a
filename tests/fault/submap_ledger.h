// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_TESTS_FAULT_SUBMAP_LEDGER_H_
#define OVERTONE_TESTS_FAULT_SUBMAP_LEDGER_H_

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "overtone/tests/support/scripted_mapping_server.h"

namespace overtone {

// A server that keeps the books of one mission over any number of streams: what it stored, in which
// order, and what came twice. It asks for every cloud until it has it.
class SubmapLedger {
 public:
  struct Books {
    std::vector<std::string> submaps;  // serialised, by order of arrival; [i] has sequence i
    int64_t sent_again = 0;            // of equal content
    int64_t conflicts = 0;             // a sequence that is stored, with other content
    int64_t gaps = 0;
    int64_t clouds = 0;
    int64_t clouds_lacking = 0;
    int64_t clouds_gone = 0;  // the robot said so
  };

  grpc::Status Serve(ScriptedMappingServer::Upload& upload);
  Books books() const;

 private:
  // Of one stream.
  struct Stream {
    std::set<std::string> asked;  // and not answered
    std::string assembled;
  };

  void Take(const v1::Submap& submap, ScriptedMappingServer::Upload& upload);
  void Take(const v1::BlobChunk& chunk, Stream& stream, ScriptedMappingServer::Upload& upload);
  void Ask(Stream& stream, ScriptedMappingServer::Upload& upload);

  mutable absl::Mutex mutex_;
  Books books_ ABSL_GUARDED_BY(mutex_);
  std::map<std::string, int64_t> lacking_ ABSL_GUARDED_BY(mutex_);  // bytes by digest
};

}  // namespace overtone

#endif  // OVERTONE_TESTS_FAULT_SUBMAP_LEDGER_H_
