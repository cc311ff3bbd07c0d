# SPDX-License-Identifier: Apache-2.0
# One entry point per file fuzz/fuzz_*.c. With IMUKIT_FUZZ they are libFuzzer programs (target
# `fuzzers`, run by tools/run_fuzz); in every build they are replayed on their saved inputs and on
# mutations of them by fuzz/replay.c, as tests.

if(NOT IMUKIT_FUZZ AND NOT IMUKIT_TESTS)
  return()
endif()

# The files of fuzz/harness.c: links to descriptors 100, 101 … of whichever process looks.
set(fuzz_files ${PROJECT_BINARY_DIR}/fuzz-files)
file(MAKE_DIRECTORY ${fuzz_files})
set(descriptor 100)
foreach(file table script.yaml matrix.npy matrix.npy.columns campaign.h5.part)
  file(CREATE_LINK /dev/fd/${descriptor} ${fuzz_files}/${file} SYMBOLIC)
  math(EXPR descriptor "${descriptor} + 1")
endforeach()
add_library(fuzz-harness OBJECT EXCLUDE_FROM_ALL fuzz/harness.c)
target_compile_definitions(fuzz-harness PUBLIC FUZZ_FILES="${fuzz_files}")
target_include_directories(fuzz-harness PUBLIC src)
target_link_libraries(fuzz-harness PUBLIC imukit-io m)

file(GLOB fuzz_sources CONFIGURE_DEPENDS fuzz/fuzz_*.c)
add_custom_target(fuzzers)
foreach(source ${fuzz_sources})
  get_filename_component(name ${source} NAME_WE)
  string(REGEX REPLACE "^fuzz_" "" subject ${name})
  if(IMUKIT_FUZZ)
    add_executable(${name} EXCLUDE_FROM_ALL ${source})
    target_link_options(${name} PRIVATE -fsanitize=fuzzer)
    add_dependencies(fuzzers ${name})
  else()
    add_executable(${name} ${source} fuzz/replay.c)
    add_test(NAME ${name} COMMAND ${name} ${PROJECT_SOURCE_DIR}/fuzz/corpus/${subject})
    set_tests_properties(${name} PROPERTIES LABELS fuzz TIMEOUT 120)
  endif()
  target_link_libraries(${name} PRIVATE fuzz-harness)
endforeach()
