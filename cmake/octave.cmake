# SPDX-License-Identifier: Apache-2.0
# Functions of GNU Octave (docs/matlab.md), where its mkoctfile is there, built on request: build/octave
# is what users add to their path.

find_program(MKOCTFILE mkoctfile)
mark_as_advanced(MKOCTFILE)
if(NOT MKOCTFILE)
  return()
endif()
execute_process(COMMAND ${MKOCTFILE} -p OCTINCLUDEDIR OUTPUT_VARIABLE octave_headers
                OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)

file(GLOB gateway_sources CONFIGURE_DEPENDS matlab/*.c)
file(GLOB octave_functions CONFIGURE_DEPENDS matlab/imukit_*.m)
add_library(imukit-gateway MODULE EXCLUDE_FROM_ALL ${gateway_sources})
target_include_directories(imukit-gateway PRIVATE cli)
target_include_directories(imukit-gateway SYSTEM PRIVATE ${octave_headers})
target_link_libraries(imukit-gateway PRIVATE imukit-verbs)
set_target_properties(imukit-gateway PROPERTIES OUTPUT_NAME imukit_gateway PREFIX "" SUFFIX .mex
                      C_VISIBILITY_PRESET default LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/octave)
add_custom_target(octave DEPENDS imukit-gateway VERBATIM
  COMMAND ${CMAKE_COMMAND} -E copy_if_different ${octave_functions} ${PROJECT_BINARY_DIR}/octave)
