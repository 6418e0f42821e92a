// SPDX-License-Identifier: Apache-2.0
// One thing to be made durable: written within a batch's transaction, shown in the index and told
// to the sink after its commit, answered last.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_STORE_OPERATION_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_STORE_OPERATION_H_

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "overtone/services/mapping_server/submap_store.h"
#include "overtone/services/mapping_server/submap_store/batch_plan.h"
#include "overtone/services/mapping_server/submap_store/store_index.h"
#include "overtone/services/mapping_server/submap_store/store_tables.h"

namespace overtone {

// What the sink is to be told, in order.
using SinkCalls = std::vector<std::function<void(const SubmapStore::Sink&)>>;

// All of it runs on the writer's thread. Write may be called again, for a batch that is tried
// again.
class StoreOperation {
 public:
  virtual ~StoreOperation() = default;

  // Whose turn it takes (operation_queue.h), and how much of a batch.
  virtual std::string lane() const = 0;
  virtual int64_t bytes() const { return 0; }
  // Not together with others in a transaction.
  virtual bool alone() const { return false; }

  // A refusal is remembered for Finish; an error here is the database's and ends the batch.
  virtual absl::Status Write(BatchPlan& plan, StoreTables& tables) = 0;
  // The batch is durable.
  virtual void Publish(StoreIndex& index, SinkCalls& calls) = 0;
  // Nothing of the batch could be stored: what the sink is to be told all the same.
  virtual void PublishUnstored(StoreIndex&, SinkCalls&) {}
  // Last. `batch`: not ok when nothing of it is stored.
  virtual void Finish(const absl::Status& batch) = 0;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_STORE_OPERATION_H_
