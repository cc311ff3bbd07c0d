#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# The tests that lend threads to the library, with the thread sanitizer.
set -eu
cd "$(dirname "$0")/.."
tests=$(grep -lE 'imk_thread_pool_create' tests/*/test_*.c | xargs -n 1 basename -s .c)
names="($(echo $tests | tr ' ' '|'))"
cmake --preset threads -DIMUKIT_COMMAND=OFF -DIMUKIT_TEST_FILTER="$names\\." >/dev/null
cmake --build --preset threads -j "$(nproc)" --target imukit-tests >/dev/null
export IMUKIT_TEST_DRAWS=${IMUKIT_TEST_DRAWS:-1000000}
export IMUKIT_TEST_RUNS=${IMUKIT_TEST_RUNS:-8}
ctest --preset threads -j "$(nproc)" --no-tests=error -R "^$names\$"
