#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# libimukit compiles unchanged, without a warning, for a Cortex-M4F and for WebAssembly; on the
# Cortex its objects hold no writable data, and they link with newlib and libm alone.
set -eu
cd "$(dirname "$0")/.."
core=$(find src/base src/model src/noise src/motion src/simulate src/identify src/physics \
    src/compensate src/calibrate src/navigate -name '*.c' 2>/dev/null | sort)
warnings="-Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Wstrict-prototypes
    -Wmissing-prototypes -Werror"
export flags="-std=c17 -O2 -Iinclude -Isrc -ffp-contract=off $(echo $warnings)"
export cortex="-mcpu=cortex-m4 -mthumb -mfloat-abi=hard -mfpu=fpv4-sp-d16"
out=build-check/portable
rm -rf "$out"
mkdir -p "$out/cortex-m4" "$out/wasm32"

compile_file() {
    local object
    object=$(echo "${1%.c}" | tr / _).o
    arm-none-eabi-gcc $cortex $flags -Wdouble-promotion -ffunction-sections -fdata-sections -c "$1" \
        -o "build-check/portable/cortex-m4/$object" || return 1
    # Both clang and this compiler see each file, so what only one of them warns about is found.
    clang --target=wasm32-wasi $flags -c "$1" -o "build-check/portable/wasm32/$object"
}
export -f compile_file
echo "$core" | xargs -P "$(nproc)" -I{} bash -c 'compile_file {} || exit 1'

if tools/writable_data.sh arm-none-eabi-objdump "$out"/cortex-m4/*.o; then
    echo "writable data (above): make it const, or give it to the caller"
    exit 1
fi

arm-none-eabi-gcc $cortex $flags -Wno-error --specs=nosys.specs -Wl,--gc-sections \
    examples/identify_record.c "$out"/cortex-m4/*.o -lm -o "$out/identify_record.elf" \
    2>"$out/link.log" || { grep -v 'is not implemented' "$out/link.log"; exit 1; }
echo "$(echo "$core" | wc -l) files; on a Cortex-M4F, identification takes" \
    "$(arm-none-eabi-size -A "$out/identify_record.elf" |
       awk '$1 == ".text" { print int($2 / 1024) }') KiB with its C library"
