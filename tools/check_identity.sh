#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# A log, and the readings of the instruments, are the same bits whatever made them: gcc or clang, -O0 or -O3, every kernel this machine
# has, 1, 2 or 7 threads, a C library told that the processor has neither FMA nor AVX2 (its own exp,
# log, sin and pow then give other bits), and AArch64, by emulation.
set -eu
cd "$(dirname "$0")/.."
out=build-check/identity
mkdir -p "$out"
model=tests/identity/all_terms.yaml

for compiler in gcc clang; do
    for level in O0 O3; do
        build=$out/$compiler-$level
        cmake -S . -B "$build" -DCMAKE_C_COMPILER=$compiler -DCMAKE_BUILD_TYPE=Release \
            -DCMAKE_C_FLAGS_RELEASE="-$level -DNDEBUG" -DIMUKIT_SHARED=OFF -DIMUKIT_TESTS=OFF \
            -DIMUKIT_EXAMPLES=OFF >/dev/null
        # A warning of either compiler at any level is a fault as well.
        cmake --build "$build" -j "$(nproc)" --target imukit-command >"$build/build.log" 2>&1 ||
            { cat "$build/build.log"; exit 1; }
        if grep -A 8 'warning:' "$build/build.log"; then
            exit 1
        fi
    done
done

# simulate BUILD THREADS: the sum of the log's bytes, with the environment as it is
simulate() {
    {
        "$out/$1/imukit" simulate "$model" --rate 100Hz --duration 20s --seed 1 --threads "$2" -o -
        "$out/$1/imukit" simulate "$model" --motion tests/identity/motion.yaml \
            --temperature tests/identity/temperature.yaml --rate 100Hz --seed 1 --threads "$2" -o -
    } 2>/dev/null | sha256sum | cut -d' ' -f1
}

# Both logs are made, or the sums mean nothing.
"$out/gcc-O3/imukit" simulate "$model" --rate 100Hz --duration 1s -o "$out/rest.csv" 2>/dev/null
"$out/gcc-O3/imukit" simulate "$model" --motion tests/identity/motion.yaml \
    --temperature tests/identity/temperature.yaml --rate 100Hz -o "$out/moving.csv"
reference=$(simulate gcc-O3 1)
[ "$reference" != "$(printf '' | sha256sum | cut -d' ' -f1)" ] || { echo "no log was made"; exit 1; }
variants=1
status=0
compare() { # NAME SUM
    variants=$((variants + 1))
    [ "$2" = "$reference" ] || { echo "$1: other bytes than gcc -O3 with one thread"; status=1; }
}

for build in gcc-O0 gcc-O3 clang-O0 clang-O3; do
    for isa in scalar avx2 avx512; do
        compare "$build, $isa kernel" "$(IMUKIT_ISA=$isa simulate $build 1)"
    done
    for threads in 2 7; do
        compare "$build, $threads threads" "$(simulate $build $threads)"
    done
done

# That the C library heeds the tunable is checked too: else this part would prove nothing.
tunable=glibc.cpu.hwcaps=-FMA,-AVX2
loader=$(ls /lib64/ld-linux-x86-64.so.2 2>/dev/null || true)
active() { "$loader" --list-diagnostics | grep -E 'cpu_features.features.*active'; }
if [ -n "$loader" ] && [ "$(active)" != "$(GLIBC_TUNABLES=$tunable active)" ]; then
    compare "without FMA and AVX2 in the C library" "$(GLIBC_TUNABLES=$tunable simulate gcc-O3 2)"
else
    echo "the C library knows no $tunable, or this processor has neither: not checked"
fi

# The core alone, without the command: a log, and the readings of the instruments, as hashes. By both
# compilers at both levels, and on another processor with its NEON kernel and the portable one.
programs="simulate_hash physics_hash"
flags="-std=c17 -O2 -ffp-contract=off -Iinclude -Isrc"
core=$(find src/base src/model src/noise src/motion src/simulate src/physics -name '*.c')
objects=$out/aarch64
rm -rf "$objects"
mkdir -p "$objects"
printf '%s\n' $core | xargs -P "$(nproc)" -I{} sh -c \
    'aarch64-linux-gnu-gcc '"$flags"' -c "$1" -o "$2/$(basename "$1" .c).o"' _ {} "$objects"
for program in $programs; do
    for build in gcc-O3 gcc-O0 clang-O0 clang-O3; do
        gcc $flags tests/identity/$program.c "$out/$build/libimukit.a" -lm -o "$out/$program-$build"
    done
    aarch64-linux-gnu-gcc $flags -static tests/identity/$program.c "$objects"/*.o -lm \
        -o "$out/$program-aarch64"
    here=$("$out/$program-gcc-O3")
    for build in gcc-O0 clang-O0 clang-O3; do
        [ "$here" = "$("$out/$program-$build")" ] ||
            { echo "$program, $build: other bits than gcc -O3"; status=1; }
    done
    [ "$here" = "$(IMUKIT_ISA=scalar "$out/$program-gcc-O3")" ] ||
        { echo "$program, scalar kernel: other bits than the fastest"; status=1; }
    for isa in neon scalar; do
        there=$(IMUKIT_ISA=$isa qemu-aarch64 "$out/$program-aarch64")
        [ "$here" = "$there" ] ||
            { echo "$program, AArch64, $isa kernel: $there, on this machine $here"; status=1; }
    done
done
variants=$((variants + 2)) # AArch64
[ $status = 0 ] && echo "$variants ways, one log; instruments alike"
exit $status
