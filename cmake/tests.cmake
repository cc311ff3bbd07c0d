# SPDX-License-Identifier: Apache-2.0
# One cmocka program per file tests/<module>/test_*.c, named by the file, labelled by the module.

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
set(imukit_test_timeout 120)
if(IMUKIT_SANITIZE OR CMAKE_BUILD_TYPE STREQUAL Debug)
  set(imukit_test_timeout 600)
endif()

file(GLOB test_sources CONFIGURE_DEPENDS tests/*/test_*.c)
foreach(source ${test_sources})
  get_filename_component(name ${source} NAME_WE)
  get_filename_component(folder ${source} DIRECTORY)
  get_filename_component(module ${folder} NAME)
  add_executable(${name} ${source})
  target_include_directories(${name} PRIVATE src tests)
  target_link_libraries(${name} PRIVATE imukit-io PkgConfig::cmocka ZLIB::ZLIB m)
  target_compile_definitions(${name} PRIVATE
    SOURCE_DIRECTORY="${PROJECT_SOURCE_DIR}"
    SHARED_DIRECTORY="${PROJECT_SOURCE_DIR}/../shared")
  add_test(NAME ${name} COMMAND ${name})
  set_tests_properties(${name} PROPERTIES LABELS ${module} TIMEOUT ${imukit_test_timeout})
  if(module STREQUAL cli AND TARGET imukit-command)
    add_dependencies(${name} imukit-command)
    target_compile_definitions(${name} PRIVATE IMUKIT_COMMAND="$<TARGET_FILE:imukit-command>")
    target_link_libraries(${name} PRIVATE PkgConfig::jansson)
  endif()
endforeach()

# Results files are made and read there as others would.
if(TARGET test_campaign_file)
  target_link_libraries(test_campaign_file PRIVATE PkgConfig::hdf5)
endif()

# MPI itself is not clean under the sanitizers.
if(TARGET imukit-mpi AND TARGET test_mpi AND NOT IMUKIT_SANITIZE)
  add_dependencies(test_mpi imukit-mpi)
  target_compile_definitions(test_mpi PRIVATE IMUKIT_MPI_COMMAND="$<TARGET_FILE:imukit-mpi>")
endif()
