#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# libimukit and libimukit-physics compile unchanged, without a warning, for a Cortex-M4F and for
# WebAssembly. On the Cortex their objects hold no writable data, and link with newlib and libm alone.
# So do the jobs and the renderers of results for WebAssembly, as far as a program here needs them;
# tools/check web compiles the rest.
# WebAssembly is run by Node: the examples that need nothing else, and the two programs that hash
# what must be the same bits everywhere, say there what they say here. The stack is what wasm-ld makes
# it, 64 KiB; it stands below the data, so that to overflow it is to stop.
set -eu
cd "$(dirname "$0")/.."
build=${BUILD:-build}
out=build-check/portable
mkdir -p "$out"

tools/compile_cortex.sh
if tools/writable_data.sh arm-none-eabi-objdump build-check/cortex-m4/*.o; then
    echo "writable data (above): make it const, or give it to the caller"
    exit 1
fi

arm-none-eabi-gcc -mcpu=cortex-m4 -mthumb -mfloat-abi=hard -mfpu=fpv4-sp-d16 -std=c17 -O2 \
    -Iinclude -ffp-contract=off --specs=nosys.specs -Wl,--gc-sections \
    examples/identify_record.c build-check/cortex-m4/*.o -lm -o "$out/identify_record.elf" \
    2>"$out/link.log" || { grep -v 'is not implemented' "$out/link.log"; exit 1; }

tools/release_build.sh imukit-physics imukit-io
# What includes a header of imukit-io needs more.
io='campaign|design_file|figure_file|firmware_file|io|log|model_file|motion_file|output_file|parameter_file'
programs=$(grep -LE "\"imukit/($io|thread_pool)\.h\"" examples/*.c)
programs="$programs tests/identity/simulate_hash.c tests/identity/physics_hash.c"
for source in $programs; do
    gcc -std=c17 -O2 -Iinclude -ffp-contract=off -c "$source" -o "$out/$(basename "$source" .c).o"
done
files=$(tools/core_files.sh; find src/jobs src/report -name '*.c')
needed="/($(tools/needed_files.sh "$out"/*.o | paste -sd'|'))$"
clang="clang-19 --target=wasm32-wasi"
tools/compile_core.sh "$out/wasm32" "$(grep -E "$needed" <<<"$files")" $clang -O2

run=0
for source in $programs; do
    name=$(basename "$source" .c)
    gcc "$out/$name.o" \
        -Wl,--start-group "$build"/libimukit{,-physics,-io}.a -Wl,--end-group -lm -o "$out/$name"
    $clang -std=c17 -O2 -Iinclude -ffp-contract=off -Wl,--stack-first \
        "$source" "$out"/wasm32/*.o -lm -o "$out/$name.wasm"
    IMUKIT_ISA=scalar "$out/$name" >"$out/$name.expected"
    node --no-warnings tools/run_wasm.mjs "$out/$name.wasm" >"$out/$name.said" ||
        { echo "$source fails in WebAssembly with a stack of 64 KiB"; exit 1; }
    diff "$out/$name.expected" "$out/$name.said" ||
        { echo "$source says something else in WebAssembly (>) than here (<)"; exit 1; }
    run=$((run + 1))
done
[ "$run" -ge 4 ] || { echo "only $run programs were run: are the examples still there?"; exit 1; }

echo "$(ls build-check/cortex-m4/*.o | wc -l) files; on a Cortex-M4F, identification takes" \
    "$(arm-none-eabi-size -A "$out/identify_record.elf" |
       awk '$1 == ".text" { print int($2 / 1024) }') KiB with its C library;" \
    "in WebAssembly $run programs say the same"
