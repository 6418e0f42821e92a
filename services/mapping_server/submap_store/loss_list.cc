// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/submap_store/loss_list.h"

#include <algorithm>

#include "spdlog/spdlog.h"

namespace overtone {

void LossList::Add(const std::string& what) {
  if (IsNew(what)) spdlog::error("store damaged: {}", what);
}

void LossList::Remember(const std::string& what) { IsNew(what); }

std::vector<std::string> LossList::All() const {
  absl::MutexLock lock(&mutex_);
  return losses_;
}

bool LossList::IsNew(const std::string& what) {
  absl::MutexLock lock(&mutex_);
  if (std::find(losses_.begin(), losses_.end(), what) != losses_.end()) return false;
  losses_.push_back(what);
  return true;
}

}  // namespace overtone
