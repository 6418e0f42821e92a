// SPDX-License-Identifier: Apache-2.0
// Numbers into text that reads back as the same number. Independent of the locale.
#ifndef OVERTONE_CORE_COMMON_FORMAT_NUMBER_H_
#define OVERTONE_CORE_COMMON_FORMAT_NUMBER_H_

#include <string>

#include "overtone/core/common/timestamp.h"

namespace overtone {

// The shortest decimal that reads back as the same double: 0.1, not 0.10000000000000001.
std::string FormatDouble(double value);

// Seconds with all nine decimals: 1403636580.838555648.
std::string FormatSeconds(Timestamp stamp);

}  // namespace overtone

#endif  // OVERTONE_CORE_COMMON_FORMAT_NUMBER_H_
