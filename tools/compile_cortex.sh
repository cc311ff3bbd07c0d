#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# libimukit and libimukit-physics for a Cortex-M4F in build-check/cortex-m4, each object with the compiler's call graph and
# frames (.ci) beside it; nothing to do when it is newer than what it is made of.
set -eu
cd "$(dirname "$0")/.."
files=$(tools/core_files.sh)
out=build-check/cortex-m4
mkdir -p "$out"
exec 9>"$out.lock" # two checks use them
flock 9
made_of=(include tools/compile_core.sh tools/compile_cortex.sh src)
[ -e "$out/made" ] && [ -z "$(find "${made_of[@]}" -newer "$out/made" -print -quit)" ] && exit
touch build-check/cortex-m4.begun
tools/compile_core.sh "$out" "$files" arm-none-eabi-gcc -mcpu=cortex-m4 -mthumb \
    -mfloat-abi=hard -mfpu=fpv4-sp-d16 -O2 -Wdouble-promotion -ffunction-sections -fdata-sections \
    -fcallgraph-info=su
mv build-check/cortex-m4.begun "$out/made"
