// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_DIGEST_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_DIGEST_H_

#include <string>

#include "google/protobuf/message_lite.h"

namespace overtone {

// SHA-256, 32 bytes, of the message's deterministic serialisation: equal content, equal digest,
// within one build of protobuf. Tells a submap sent again from another one under the same sequence.
std::string Sha256(const google::protobuf::MessageLite& message);

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_DIGEST_H_
