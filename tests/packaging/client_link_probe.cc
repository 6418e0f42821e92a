// SPDX-License-Identifier: Apache-2.0
// A robot's program as far as the linker is concerned: it pulls in all of the client.
#include "overtone/client/mapping_client.h"

int main() { return overtone::MappingClient::Create({}, nullptr).ok() ? 1 : 0; }
