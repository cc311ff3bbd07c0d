#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# The tests that lend threads to the library, with the thread sanitizer, and only what the linker
# takes of the libraries for them.
set -eu
cd "$(dirname "$0")/.."
build=${BUILD:-build}
tests=$(grep -rlE --include='test_*.c' imk_thread_pool_create tests)
names="($(basename -s .c $tests | paste -sd'|'))"
tools/release_build.sh imukit-tests
files=$(tools/needed_files.sh $(printf "$build/CMakeFiles/imukit-tests.dir/%s.o " $tests) | paste -sd'|')
cmake --preset threads -DIMUKIT_COMMAND=OFF -DIMUKIT_TEST_FILTER="$names\\." \
    -DIMUKIT_FILE_FILTER="($files)" >/dev/null
cmake --build --preset threads -j "$(nproc)" --target imukit-tests >/dev/null
export IMUKIT_TEST_DRAWS=${IMUKIT_TEST_DRAWS:-1000000}
export IMUKIT_TEST_RUNS=${IMUKIT_TEST_RUNS:-20}
ctest --preset threads -j "$(nproc)" --no-tests=error -R "^$names\$"
