#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# The tests with the address, leak and undefined-behaviour sanitizers. Cases that reach no place in
# the libraries and the command that the others do not reach, or few for their time, are left out
# (tools/select_sanitized.py); with --all, all are run.
set -eu
cd "$(dirname "$0")/.."
tools/sanitized_build.sh >/dev/null

[ "${1:-}" = --all ] || export IMUKIT_TESTS_LEFT_OUT=$PWD/tests/left_out_sanitized.txt
# Not detect_stack_use_after_return: gcc 12 misaligns 64-byte vectors on the stack it makes for that.
export ASAN_OPTIONS=strict_string_checks=1
export UBSAN_OPTIONS=print_stacktrace=1
# Tests that draw hundreds of millions of numbers honour this; the sanitizers need no more.
export IMUKIT_TEST_DRAWS=${IMUKIT_TEST_DRAWS:-1000000}
# The repetitions of statistical tests are divided by this.
export IMUKIT_TEST_RUNS=${IMUKIT_TEST_RUNS:-20}
ctest --preset sanitize -j "$(nproc)" --no-tests=error
