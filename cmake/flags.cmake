# SPDX-License-Identifier: Apache-2.0
# Language, warnings and sanitizers of everything built here.

set(CMAKE_C_STANDARD 17)
set(CMAKE_C_STANDARD_REQUIRED ON)
set(CMAKE_C_EXTENSIONS OFF)
set(CMAKE_C_VISIBILITY_PRESET hidden)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)

# Logs have the same bytes everywhere, so no fused or reordered arithmetic anywhere, and neither
# link-time optimisation nor -march=native.
set(imukit_flags -ffp-contract=off
    -Wall -Wextra -Wpedantic -Wshadow -Wstrict-prototypes -Wmissing-prototypes
    -Wconversion -Wno-sign-conversion)
if(CMAKE_C_COMPILER_ID STREQUAL GNU) # clang takes NAN and INFINITY for promotions
  list(APPEND imukit_flags -Wdouble-promotion)
endif()
if(IMUKIT_SANITIZE)
  # -w: the release build has said what there is to warn about, and takes a tenth longer for it.
  list(APPEND imukit_flags -fsanitize=${IMUKIT_SANITIZE} -fno-sanitize-recover=all
       -fno-omit-frame-pointer -w)
  add_link_options(-fsanitize=${IMUKIT_SANITIZE})
  # What starts 2000 times in the tests has to start fast: without half a million addresses to
  # relocate, and without a description of each place that could go wrong. Undefined behaviour then
  # ends in an illegal instruction, of which a debugger tells the line.
  if(NOT IMUKIT_FUZZ AND CMAKE_C_COMPILER_ID STREQUAL GNU)
    set(CMAKE_POSITION_INDEPENDENT_CODE OFF)
    # Sizes of objects are what the address sanitizer knows better; gcc takes a fifth longer for them.
    list(APPEND imukit_flags -fno-pie -fsanitize-undefined-trap-on-error -fno-sanitize=object-size)
    add_link_options(-no-pie)
  endif()
endif()
# With sanitizers, optimising code takes twice as long as compiling it: tests, command and files are
# run too little to give that back.
set(imukit_seldom_run "")
if(IMUKIT_SANITIZE AND NOT IMUKIT_FUZZ)
  set(imukit_seldom_run -O0)
endif()
# What a fuzzer meets in the library guides it: edges are counted there too.
if(IMUKIT_FUZZ)
  list(APPEND imukit_flags -fsanitize=fuzzer-no-link)
endif()
add_compile_options("$<$<COMPILE_LANGUAGE:C>:${imukit_flags}>")
