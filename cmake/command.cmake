# SPDX-License-Identifier: Apache-2.0
# The command `imukit`, and the manual pages and shell completion it writes about itself.

file(GLOB cli_sources CONFIGURE_DEPENDS cli/*.c)
if(NOT cli_sources)
  return()
endif()
pkg_check_modules(jansson REQUIRED IMPORTED_TARGET jansson)
add_executable(imukit-command ${cli_sources})
set_target_properties(imukit-command PROPERTIES OUTPUT_NAME imukit)
target_link_libraries(imukit-command PRIVATE imukit-io PkgConfig::jansson m)

# They come from the option tables the parser reads, so they cannot disagree with it.
if(NOT CMAKE_CROSSCOMPILING)
  set(manual_directory ${PROJECT_BINARY_DIR}/manual)
  add_custom_command(OUTPUT ${manual_directory}/imukit.bash
    COMMAND ${CMAKE_COMMAND} -D COMMAND=$<TARGET_FILE:imukit-command> -D OUTPUT=${manual_directory}
            -P ${PROJECT_SOURCE_DIR}/cmake/write_manuals.cmake
    DEPENDS imukit-command cmake/write_manuals.cmake VERBATIM)
  add_custom_target(manuals ALL DEPENDS ${manual_directory}/imukit.bash)
endif()
