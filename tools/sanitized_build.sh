#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Builds all, or what the options of `cmake --build` say, with the sanitizers. Two checks use that
# build and may run at the same time: the second waits for the first.
set -eu
cd "$(dirname "$0")/.."
mkdir -p build-check
exec 9>build-check/sanitize.lock
flock 9
cmake --preset sanitize
cmake --build --preset sanitize -j "$(nproc)" "$@"
