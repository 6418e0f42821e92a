// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/log_fields.h"

#include "overtone/core/common/ids.h"

namespace overtone {

LogFields LogFieldsOf(const std::string& map, const std::string& robot,
                      const std::string& mission) {
  const auto id_or_nothing = [](const std::string& name) {
    return ValidateId(name, "").ok() ? name : std::string();
  };
  LogFields fields;
  fields.map = id_or_nothing(map);
  fields.robot = id_or_nothing(robot);
  fields.mission = id_or_nothing(mission);
  return fields;
}

}  // namespace overtone
