#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# The names of the libraries: what libimukit and libimukit-physics ask for (libm and a few of string.h,
# nothing that allocates, prints or opens), what they keep (no writable data), what each library
# gives (every function its headers declare, and no other).
set -u
cd "$(dirname "$0")/.."
build=${BUILD:-build}
tools/release_build.sh imukit-physics imukit-io-shared || exit 1
status=0
complain() { echo "$*"; status=1; }

# getenv: IMUKIT_ISA. __cpu_model and __cpu_indicator_init: __builtin_cpu_supports, in libgcc.
allowed='mem(cpy|move|set|cmp|chr)|str(len|nlen|n?cpy|n?cmp|r?chr|str|c?spn|pbrk)|getenv'
allowed="$allowed|__cpu_model|__cpu_indicator_init|_GLOBAL_OFFSET_TABLE_"
libm=$(nm -D --defined-only "$(gcc -print-file-name=libm.so.6)" | sed 's/.* //; s/@.*//' | sort -u)

core=("$build/libimukit.a" "$build/libimukit-physics.a")
names() { nm -A "$@" "${core[@]}" 2>/dev/null; } # of symbols, each behind its file
for name in $(names --undefined-only | awk 'NF > 1 { print $NF }' | sort -u |
    comm -23 - <(names --defined-only | awk '{ print $NF }' | sort -u) | comm -23 - <(echo "$libm") |
    grep -vxE "$allowed"); do
    complain "the core asks for $name:" $(names --undefined-only |
        awk -v name="$name" '$NF == name { split($1, part, ":"); print part[2] }' | sort -u)
done
for name in $(nm --undefined-only "$build/libimukit.a" 2>/dev/null | awk '{ print $2 }' | sort -u |
    comm -12 - <(nm --defined-only "$build/libimukit-physics.a" 2>/dev/null | awk '{ print $3 }' |
        sort -u)); do
    complain "libimukit asks for $name, which libimukit-physics has"
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

if tools/writable_data.sh objdump "${core[@]}"; then
    complain "the core holds writable data (above)"
fi

declared() { # functions and constants with IMK_API in the headers given
    cat "$@" | gcc -std=c17 -Iinclude -fpreprocessed -E -P - 2>/dev/null | tr '\n' ' ' |
        grep -oE 'IMK_API [^;{]*;' | grep -oE 'imk_[a-z0-9_]+ *\(|extern const [a-z_]+ imk_[a-z0-9_]+;' |
        sed 's/.* //; s/[(;]//' | tr -d ' (' | sort -u
}
count=0
compare() { # LIBRARY HEADER…: what it exports, and what these and those they gather declare
    local headers="${*:2} $(sed -n 's/#include "\(.*\)"/include\/\1/p' "${@:2}")" exported name
    exported=$(nm -D --defined-only "$build/$1.so" | awk 'NF == 3 { print $3 }' | sort -u)
    for name in $(comm -13 <(declared $headers) <(echo "$exported")); do
        complain "$1 exports $name, which no header of its own declares"
    done
    for name in $(comm -23 <(declared $headers) <(echo "$exported")); do
        complain "$name is declared in $(grep -lwF "$name" $headers | head -n 1), but $1 has no such function"
    done
    count=$((count + $(wc -l <<<"$exported")))
}
compare libimukit include/imukit/imukit.h
compare libimukit-physics include/imukit/physics.h
compare libimukit-io include/imukit/io.h include/imukit/jobs.h

echo "$count public functions"
exit $status
