#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# The names of the libraries: what libimukit asks for (libm and a few of string.h, nothing that
# allocates, prints or opens), what it keeps (no writable data), what it gives (every function its
# headers declare, and no other).
set -u
cd "$(dirname "$0")/.."
build=${BUILD:-build}
cmake -S . -B "$build" >/dev/null &&
    cmake --build "$build" -j "$(nproc)" \
        --target imukit imukit-io imukit-shared imukit-io-shared >/dev/null || exit 1
status=0
complain() { echo "$*"; status=1; }

# getenv: IMUKIT_ISA. __cpu_model and __cpu_indicator_init: __builtin_cpu_supports, in libgcc.
allowed='mem(cpy|move|set|cmp|chr)|str(len|nlen|n?cpy|n?cmp|r?chr|str|c?spn|pbrk)|getenv'
allowed="$allowed|__cpu_model|__cpu_indicator_init|_GLOBAL_OFFSET_TABLE_"
libm=$(nm -D --defined-only "$(gcc -print-file-name=libm.so.6)" | sed 's/.* //; s/@.*//' | sort -u)

defined=$(nm --defined-only "$build/libimukit.a" 2>/dev/null | awk 'NF == 3 { print $3 }' | sort -u)
foreign=$(nm --undefined-only "$build/libimukit.a" 2>/dev/null | awk '$1 == "U" { print $2 }' |
    sort -u | comm -23 - <(echo "$defined") | comm -23 - <(echo "$libm") |
    grep -vxE "$allowed")
for name in $foreign; do
    complain "libimukit asks for $name:" $(nm -A --undefined-only "$build/libimukit.a" 2>/dev/null |
        awk -v name="$name" '$NF == name { split($1, part, ":"); print part[2] }' | sort -u)
done

# Bytes of logs must not depend on the C library: there the elementary functions are our own.
transcendental='(exp|exp2|expm1|log|log2|log10|log1p|sin|cos|tan|sincos|asin|acos|atan|atan2|sinh'
transcendental="$transcendental|cosh|tanh|pow|cbrt|hypot|erf|erfc|tgamma|lgamma)[fl]?"
for source in $(find src/simulate src/motion src/base/random src/base/elementary.c -name '*.c' \
    ! -name '*_neon.c'); do
    object=$build/CMakeFiles/imukit-objects.dir/$source.o
    [ -e "$object" ] || complain "$source is not in $build"
    for name in $(nm --undefined-only "$object" | awk '{ print $2 }' |
        grep -xE "$transcendental"); do
        complain "$source calls the C library's $name; use imk_$name, whose bits are the same everywhere"
    done
done

if tools/writable_data.sh objdump "$build/libimukit.a"; then
    complain "libimukit holds writable data (above)"
fi

declared() { # functions and constants with IMK_API in the headers given
    cat "$@" | gcc -std=c17 -Iinclude -fpreprocessed -E -P - 2>/dev/null | tr '\n' ' ' |
        grep -oE 'IMK_API [^;{]*;' | grep -oE 'imk_[a-z0-9_]+ *\(|extern const [a-z_]+ imk_[a-z0-9_]+;' |
        sed 's/.* //; s/[(;]//' | tr -d ' (' | sort -u
}
exported=$(nm -D --defined-only "$build/libimukit.so" "$build/libimukit-io.so" |
    awk 'NF == 3 { print $3 }' | sort -u)
for name in $(comm -13 <(declared include/imukit/*.h) <(echo "$exported")); do
    complain "$name is exported, but no public header declares it"
done
for name in $(comm -23 <(declared include/imukit/*.h) <(echo "$exported")); do
    complain "$name is declared in $(grep -lwF "$name" include/imukit/*.h | head -n 1), but there is no such function"
done

echo "$(echo "$exported" | wc -l) public functions"
exit $status
