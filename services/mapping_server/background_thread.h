// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_BACKGROUND_THREAD_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_BACKGROUND_THREAD_H_

namespace overtone {

// From now on the calling thread, and those it starts, let others of the process go first (nice +5:
// a quarter of a core beside a busy thread of normal priority). For optimising, searching and
// merging, which acknowledgements are not to wait for.
void RunInBackground();

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_BACKGROUND_THREAD_H_
