# SPDX-License-Identifier: Apache-2.0
# The report and, compiled into it, its page.
find_package(nlohmann_json REQUIRED)
foreach(kind html css js)
  set(page ${CMAKE_CURRENT_SOURCE_DIR}/report_page.${kind})
  string(TOUPPER ${kind} KIND)
  file(READ ${page} REPORT_${KIND})
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${page})
endforeach()
configure_file(report_page.cc.in report_page.cc @ONLY)
overtone_library(cli_report
  SOURCES report.cc report_data.cc report_heat_map.cc report_summary.cc report_text.cc
    ${CMAKE_CURRENT_BINARY_DIR}/report_page.cc
  DEPS overtone::core_synchronization overtone::core_geometry absl::strings absl::str_format
  PRIVATE_DEPS nlohmann_json::nlohmann_json)
