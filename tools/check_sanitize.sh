#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Every test, with the address, leak and undefined-behaviour sanitizers.
set -eu
cd "$(dirname "$0")/.."
cmake --preset sanitize >/dev/null
cmake --build --preset sanitize -j "$(nproc)" >/dev/null

export ASAN_OPTIONS=detect_stack_use_after_return=1:strict_string_checks=1
export UBSAN_OPTIONS=print_stacktrace=1
# Tests that draw hundreds of millions of numbers honour this; the sanitizers need no more.
export IMUKIT_TEST_DRAWS=${IMUKIT_TEST_DRAWS:-1000000}
ctest --preset sanitize -j "$(nproc)" --no-tests=error
