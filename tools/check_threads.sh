#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# The tests that lend threads to the library, with the thread sanitizer.
set -eu
cd "$(dirname "$0")/.."
cmake --preset threads >/dev/null
tests=$(grep -lE 'imk_thread_pool_create' tests/*/test_*.c | xargs -n 1 basename -s .c)
cmake --build --preset threads -j "$(nproc)" --target $tests >/dev/null
export IMUKIT_TEST_DRAWS=${IMUKIT_TEST_DRAWS:-1000000}
ctest --preset threads -j "$(nproc)" --no-tests=error -R "^($(echo $tests | tr ' ' '|'))\$"
