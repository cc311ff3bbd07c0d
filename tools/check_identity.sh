#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# A log, and the readings of the instruments, are the same bits whatever made them.
#
# The command: as `make` builds it, with every kernel this machine has, with 1, 2 or 7 threads, with
# a C library told that the processor has neither FMA nor AVX2 (its own exp, log, sin and pow then
# give other bits), and as the sanitizers' build has it. What makes the bits is all in the core, so
# other compilers and levels, and AArch64 by emulation, compile that alone, and hash what it gives:
# a log as decimal text, and the readings.
set -eu
cd "$(dirname "$0")/.."
build=${BUILD:-build}
out=build-check/identity
mkdir -p "$out"
model=tests/identity/all_terms.yaml
status=0
complain() { echo "$*"; status=1; }

tools/release_build.sh imukit-command
tools/sanitized_build.sh --target imukit-command >"$out/build.log" 2>&1 || { cat "$out/build.log"; exit 1; }

# simulate COMMAND THREADS: the sum of two logs' bytes, with the environment as it is
simulate() {
    {
        "$1" simulate "$model" --rate 100Hz --duration 20s --seed 1 --threads "$2" -o -
        "$1" simulate "$model" --motion tests/identity/motion.yaml \
            --temperature tests/identity/temperature.yaml --rate 100Hz --seed 1 --threads "$2" -o -
    } 2>/dev/null | sha256sum | cut -d' ' -f1
}

# Both logs are made, or the sums mean nothing.
command=$build/imukit
"$command" simulate "$model" --rate 100Hz --duration 1s -o "$out/rest.csv" 2>/dev/null
"$command" simulate "$model" --motion tests/identity/motion.yaml \
    --temperature tests/identity/temperature.yaml --rate 100Hz -o "$out/moving.csv"
reference=$(simulate "$command" 1)
[ "$reference" != "$(printf '' | sha256sum | cut -d' ' -f1)" ] || { echo "no log was made"; exit 1; }
logs=1
compare() { # NAME SUM
    logs=$((logs + 1))
    [ "$2" = "$reference" ] || complain "$1: other bytes than the usual build with one thread"
}
for isa in scalar avx2 avx512; do
    compare "$isa kernel" "$(IMUKIT_ISA=$isa simulate "$command" 1)"
done
for threads in 2 7; do
    compare "$threads threads" "$(simulate "$command" $threads)"
done
for isa in scalar avx512; do
    compare "gcc -O1 with sanitizers, $isa kernel" \
        "$(IMUKIT_ISA=$isa simulate build-check/sanitize/imukit 2)"
done

# That the C library heeds the tunable is checked too: else this part would prove nothing.
tunable=glibc.cpu.hwcaps=-FMA,-AVX2
loader=$(ls /lib64/ld-linux-x86-64.so.2 2>/dev/null || true)
active() { "$loader" --list-diagnostics | grep -E 'cpu_features.features.*active'; }
if [ -n "$loader" ] && [ "$(active)" != "$(GLIBC_TUNABLES=$tunable active)" ]; then
    compare "without FMA and AVX2 in the C library" "$(GLIBC_TUNABLES=$tunable simulate "$command" 2)"
else
    echo "the C library knows no $tunable, or this processor has neither: not checked"
fi

# Only what the linker takes for the two programs.
for program in simulate_hash physics_hash; do
    gcc -std=c17 -O2 -ffp-contract=off -Iinclude -Isrc -c "tests/identity/$program.c" \
        -o "$out/$program.o"
done
core=$(tools/needed_files.sh "$out"/*_hash.o | sed 's/^/-name /; $!s/$/ -o/' | xargs find src)
core="$core $(find src -name '*_neon.c')" # which it takes on AArch64
tools/compile_core.sh "$out/gcc-O0" "$core" gcc -O0
tools/compile_core.sh "$out/clang-O3" "$core" clang -O3
tools/compile_core.sh "$out/aarch64" "$core" aarch64-linux-gnu-gcc -O2

hashes=1
hash_like() { # NAME HASH: the same as $here
    hashes=$((hashes + 1))
    [ "$2" = "$here" ] || complain "$program, $1: other bits than the usual build: $2, not $here"
}
for program in simulate_hash physics_hash; do
    main="-std=c17 -O2 -ffp-contract=off -Iinclude -Isrc tests/identity/$program.c"
    gcc $main "$build/libimukit-physics.a" "$build/libimukit.a" -lm -o "$out/$program"
    here=$("$out/$program")
    hash_like "scalar kernel" "$(IMUKIT_ISA=scalar "$out/$program")"
    for variant in gcc-O0 clang-O3; do
        gcc $main "$out/$variant"/*.o -lm -o "$out/$program-$variant"
        for isa in scalar avx2 avx512; do
            hash_like "$variant, $isa kernel" "$(IMUKIT_ISA=$isa "$out/$program-$variant")"
        done
    done
    aarch64-linux-gnu-gcc -static $main "$out"/aarch64/*.o -lm -o "$out/$program-aarch64"
    for isa in neon scalar; do
        hash_like "AArch64, $isa kernel" \
            "$(IMUKIT_ISA=$isa qemu-aarch64 "$out/$program-aarch64")"
    done
done
[ $status = 0 ] && echo "$logs ways to one log; the core and the instruments alike in $hashes"
exit $status
