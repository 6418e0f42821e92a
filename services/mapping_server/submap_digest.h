// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_DIGEST_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_DIGEST_H_

#include <string>

#include "google/protobuf/message_lite.h"

namespace overtone {

// The message's deterministic serialisation: equal content, equal bytes, within one build of
// protobuf. Its SHA-256 tells a submap sent again from another one under the same sequence.
std::string DeterministicBytes(const google::protobuf::MessageLite& message);

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_DIGEST_H_
