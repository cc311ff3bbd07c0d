#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# clang-tidy (.clang-tidy) on the libraries, the command, the examples and the fuzz entry points.
# A file whose text, headers and rules have not changed since it last passed is not looked at again.
# The analyzer works function by function (mode=shallow): following every call takes ten times as
# long, and what it finds in addition the sanitizers find when the tests run.
set -u
cd "$(dirname "$0")/.."
passed=build-check/tidy
mkdir -p "$passed"

check_file() {
    local file=$1 passed=build-check/tidy flags="-std=c17 -Iinclude -Isrc"
    local shallow="-Xclang -analyzer-config -Xclang mode=shallow"
    case $file in
        *avx2.c) flags="$flags -mavx2 -mfma" ;;
        *fma.c) flags="$flags -mfma" ;;
        *avx512.c) flags="$flags -mavx512f -mavx512dq" ;;
        */campaign_hdf5*.c)
            flags="$flags $(pkg-config --cflags hdf5-serial 2>/dev/null ||
                pkg-config --cflags hdf5)"
            ;;
        *_mpi.c)
            pkg-config --exists mpi-c || return 0
            flags="$flags $(pkg-config --cflags mpi-c)"
            ;;
    esac
    local key
    key=$({ clang $flags -E "$file" 2>&1; cat .clang-tidy; echo "$flags $shallow"; } | sha256sum | cut -d' ' -f1)
    [ -e "$passed/$key" ] && return 0
    clang-tidy --quiet "$file" -- $flags $shallow 2>/dev/null && touch "$passed/$key"
}
export -f check_file

find src cli examples fuzz -name '*.c' -print0 |
    xargs -0 -P "$(nproc)" -I{} bash -c 'check_file {} || exit 1' || exit 1
echo "$(find src cli examples fuzz -name '*.c' | wc -l) files"
