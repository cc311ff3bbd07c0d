#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# The command when memory, a file or the disk fails: some commands of `make faults`.
set -eu
cd "$(dirname "$0")/.."
export BUILD=${BUILD:-build}
tools/release_build.sh imukit-command
tools/run_faults --quick
