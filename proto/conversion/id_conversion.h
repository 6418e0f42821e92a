// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_PROTO_CONVERSION_ID_CONVERSION_H_
#define OVERTONE_PROTO_CONVERSION_ID_CONVERSION_H_

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "overtone/core/common/ids.h"
#include "overtone/core/common/timestamp.h"
#include "overtone/v1/graph.pb.h"

namespace overtone {

v1::MissionId ToProto(const MissionId& id);
v1::NodeId ToProto(const NodeId& id);

// InvalidArgument naming the field, relative to the message.
absl::StatusOr<MissionId> FromProto(const v1::MissionId& message);
absl::StatusOr<NodeId> FromProto(const v1::NodeId& message);

// In [0, 1e9]. `field` is for the error.
absl::Status ValidateKeyframeIndex(int64_t index, absl::string_view field);
// Nanoseconds in [0, 4e18].
absl::StatusOr<Timestamp> StampFromNanoseconds(int64_t stamp_ns, absl::string_view field);

}  // namespace overtone

#endif  // OVERTONE_PROTO_CONVERSION_ID_CONVERSION_H_
