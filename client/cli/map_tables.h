// SPDX-License-Identifier: Apache-2.0
// Maps and robots as a server tells of them, for people: rows for FormatTable, and single lines.
#ifndef OVERTONE_CLIENT_CLI_MAP_TABLES_H_
#define OVERTONE_CLIENT_CLI_MAP_TABLES_H_

#include <string>
#include <vector>

#include "overtone/v1/map_admin_service.pb.h"

namespace overtone {

using TableRows = std::vector<std::vector<std::string>>;

// Header first.
TableRows MapRows(const std::vector<v1::MapSummary>& maps);
TableRows RobotRows(const std::vector<v1::Robot>& robots);

// "17 accepted, 3 rejected_overlap"; "none".
std::string VerdictsText(const google::protobuf::RepeatedPtrField<v1::VerdictCount>& verdicts);

// "up and down", "up", "down", "away": which of the robot's streams are open.
std::string LinkText(const v1::Robot& robot);
// What waits on the robot: "3 submaps, 2 clouds, 1.2 MB", "nothing"; "?": it did not report.
std::string BacklogText(const v1::Robot& robot);
// "+12 ms (within 3 ms)": its clock minus the server's; "?".
std::string ClockText(const v1::Robot& robot);
// "revision 12: 3 constraints, 0.21 to 0.05 m"; "none"; "?".
std::string ComparisonText(const v1::Robot& robot);

// "1.2 MB"
std::string BytesText(int64_t bytes);
// "13:02:11", UTC; "-" when there was none.
std::string ClockTimeText(const google::protobuf::Timestamp& time);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_MAP_TABLES_H_
