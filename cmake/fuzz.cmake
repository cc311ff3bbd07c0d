# SPDX-License-Identifier: Apache-2.0
# One entry point per file fuzz/fuzz_*.c. With IMUKIT_FUZZ they are libFuzzer programs (target
# `fuzzers`, run by tools/run_fuzz); in every build they are replayed on their saved inputs and on
# mutations of them by fuzz/replay.c, as tests.

file(GLOB fuzz_sources CONFIGURE_DEPENDS fuzz/fuzz_*.c)
add_custom_target(fuzzers)
foreach(source ${fuzz_sources})
  get_filename_component(name ${source} NAME_WE)
  string(REGEX REPLACE "^fuzz_" "" subject ${name})
  if(IMUKIT_FUZZ)
    add_executable(${name} EXCLUDE_FROM_ALL ${source})
    target_compile_options(${name} PRIVATE -fsanitize=fuzzer)
    target_link_options(${name} PRIVATE -fsanitize=fuzzer)
    add_dependencies(fuzzers ${name})
  elseif(IMUKIT_TESTS)
    add_executable(${name} ${source} fuzz/replay.c)
    add_test(NAME ${name} COMMAND ${name} ${PROJECT_SOURCE_DIR}/fuzz/corpus/${subject})
    set_tests_properties(${name} PROPERTIES LABELS fuzz TIMEOUT 120)
  else()
    continue()
  endif()
  target_include_directories(${name} PRIVATE src)
  target_link_libraries(${name} PRIVATE imukit-io m)
endforeach()
