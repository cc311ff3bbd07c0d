#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Builds targets as `make` does, in $BUILD: tools/release_build.sh TARGET… Two checks that use that
# build may run at the same time: the second waits for the first.
set -eu
cd "$(dirname "$0")/.."
build=${BUILD:-build}
mkdir -p "$build"
exec 9>"$build/checks.lock"
flock 9
tests=
case " $* " in *" all "* | *" imukit-tests "*) tests=-DIMUKIT_TESTS=ON ;; esac
{ cmake -S . -B "$build" $tests && cmake --build "$build" -j "$(nproc)" --target "$@"; } \
    >"$build/checks.log" 2>&1 9>&- && ! grep -q 'warning:' "$build/checks.log" ||
    { cat "$build/checks.log"; exit 1; }
