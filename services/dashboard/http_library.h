// SPDX-License-Identifier: Apache-2.0
// cpp-httplib, without a macro that it brings along: <resolv.h> takes the name of one of Eigen's
// parameters.
#ifndef OVERTONE_SERVICES_DASHBOARD_HTTP_LIBRARY_H_
#define OVERTONE_SERVICES_DASHBOARD_HTTP_LIBRARY_H_

#include "httplib.h"

#undef _res

#endif  // OVERTONE_SERVICES_DASHBOARD_HTTP_LIBRARY_H_
