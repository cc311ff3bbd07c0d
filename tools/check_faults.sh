#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# The command when memory, a file or the disk fails: some commands of `make faults`.
set -eu
cd "$(dirname "$0")/.."
export BUILD=${BUILD:-build}
cmake -S . -B "$BUILD" >/dev/null
cmake --build "$BUILD" -j "$(nproc)" --target imukit-command >/dev/null
tools/run_faults --quick
