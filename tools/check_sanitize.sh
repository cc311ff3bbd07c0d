#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Every test, with the address, leak and undefined-behaviour sanitizers.
set -eu
cd "$(dirname "$0")/.."
tools/sanitized_build.sh >/dev/null

# Not detect_stack_use_after_return: gcc 12 misaligns 64-byte vectors on the stack it makes for that.
export ASAN_OPTIONS=strict_string_checks=1
export UBSAN_OPTIONS=print_stacktrace=1
# Tests that draw hundreds of millions of numbers honour this; the sanitizers need no more.
export IMUKIT_TEST_DRAWS=${IMUKIT_TEST_DRAWS:-1000000}
# The repetitions of statistical tests are divided by this.
export IMUKIT_TEST_RUNS=${IMUKIT_TEST_RUNS:-20}
ctest --preset sanitize -j "$(nproc)" --no-tests=error
