# SPDX-License-Identifier: Apache-2.0
# One test per file test_*.c in tests/<module>/ (cmocka), named by the file, labelled by the module.

if(IMUKIT_TESTS STREQUAL AUTO)
  pkg_check_modules(cmocka QUIET IMPORTED_TARGET cmocka)
  if(NOT cmocka_FOUND)
    message(STATUS "No tests: cmocka is not installed (Debian: libcmocka-dev)")
    set(IMUKIT_TESTS OFF)
    return()
  endif()
else()
  pkg_check_modules(cmocka REQUIRED IMPORTED_TARGET cmocka)
endif()

# A sanitized or unoptimised build is several times slower.
set(imukit_test_timeout 300)
if(IMUKIT_SANITIZE OR CMAKE_BUILD_TYPE STREQUAL Debug)
  set(imukit_test_timeout 600)
endif()

# Nearly all are one program, imukit-tests, which is linked once: `imukit-tests test_allan` runs the
# main of tests/identify/allan/test_allan.c, compiled under the file's name. Tests that put functions of
# their own in the place of the C library's are programs apart. IMUKIT_TEST_FILTER takes some tests
# only, for checks that need no more.
set(test_programs_apart test_campaign test_campaign_merge)
set(IMUKIT_TEST_FILTER "" CACHE STRING "Regular expression: build only tests of such names")
file(GLOB_RECURSE test_sources CONFIGURE_DEPENDS tests/test_*.c)
list(FILTER test_sources INCLUDE REGEX "/(${IMUKIT_TEST_FILTER})[^/]*$")
set(test_list "")
set(test_targets imukit-tests)
add_executable(imukit-tests tests/main.c tests/cli/run_command.c)
foreach(source ${test_sources})
  get_filename_component(name ${source} NAME_WE)
  string(REGEX REPLACE ".*/tests/([a-z]+)/.*" "\\1" module ${source})
  if(name IN_LIST test_programs_apart)
    add_executable(${name} ${source})
    list(APPEND test_targets ${name})
    add_test(NAME ${name} COMMAND ${name})
  else()
    target_sources(imukit-tests PRIVATE ${source})
    set_source_files_properties(${source} PROPERTIES COMPILE_DEFINITIONS main=main_${name}
                                COMPILE_OPTIONS "-include;${PROJECT_SOURCE_DIR}/tests/main.h")
    if(module MATCHES "^(cli|io|report)$") # they compute nothing: commands and the library do
      set_property(SOURCE ${source} APPEND PROPERTY COMPILE_OPTIONS -O0)
    endif()
    string(APPEND test_list "TEST_PROGRAM(${name})\n")
    add_test(NAME ${name} COMMAND imukit-tests ${name})
  endif()
  set_tests_properties(${name} PROPERTIES LABELS ${module} TIMEOUT ${imukit_test_timeout})
endforeach()
file(CONFIGURE OUTPUT test_programs.inc CONTENT "${test_list}" @ONLY)
foreach(target ${test_targets})
  target_include_directories(${target} PRIVATE src tests ${PROJECT_BINARY_DIR})
  # Results files are made and read as others would, so HDF5 is one of theirs.
  target_link_libraries(${target} PRIVATE imukit-io PkgConfig::cmocka PkgConfig::hdf5 ZLIB::ZLIB m)
  target_compile_definitions(${target} PRIVATE
    SOURCE_DIRECTORY="${PROJECT_SOURCE_DIR}"
    SHARED_DIRECTORY="${PROJECT_SOURCE_DIR}/../shared")
endforeach()
# Optimised they take twice as long to compile, and no less to run: the time is spent in the libraries.
# Except in the definitions of Allan variances, taken literally: 5.7 s without, 2 s with.
target_compile_options(imukit-tests PRIVATE -O0)
set_property(SOURCE ${PROJECT_SOURCE_DIR}/tests/identify/allan/test_allan_family.c
             APPEND PROPERTY COMPILE_OPTIONS -O2)
if(TARGET imukit-command)
  add_dependencies(imukit-tests imukit-command)
  target_compile_definitions(imukit-tests PRIVATE IMUKIT_COMMAND="$<TARGET_FILE:imukit-command>")
  pkg_check_modules(jansson REQUIRED IMPORTED_TARGET jansson) # reads what --json prints
  target_link_libraries(imukit-tests PRIVATE PkgConfig::jansson)
endif()

# MPI itself is not clean under the sanitizers.
if(TARGET imukit-mpi AND NOT IMUKIT_SANITIZE)
  add_dependencies(imukit-tests imukit-mpi)
  target_compile_definitions(imukit-tests PRIVATE IMUKIT_MPI_COMMAND="$<TARGET_FILE:imukit-mpi>")
endif()
