#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Compiles files of libimukit and libimukit-physics apart from the build, without a warning, into DIRECTORY/NAME.o:
#
#     tools/compile_core.sh DIRECTORY "FILE…" COMPILER FLAG…
set -eu
export directory=$1
files=$2
shift 2
rm -rf "$directory"
mkdir -p "$directory"
# clang 19 would have enumerated numbers converted by hand.
enumerated=
case $1 in clang*) enumerated=-Wno-enum-float-conversion ;; esac
export compile="$* -std=c17 -ffp-contract=off -Iinclude -Isrc -Wall -Wextra -Wpedantic -Wshadow
    -Wconversion -Wno-sign-conversion -Wstrict-prototypes -Wmissing-prototypes $enumerated -Werror"
case $("$@" -dumpmachine) in x86_64*) export kernels=1 ;; *) export kernels=0 ;; esac

compile_files() {
    local source flags
    for source in "$@"; do
        flags=
        # Kernels of one instruction set are compiled for it (cmake/libraries.cmake).
        [ $kernels = 0 ] || case $source in
            *_avx2.c) flags="-mavx2 -mfma" ;;
            *_fma.c) flags=-mfma ;;
            *_avx512.c) flags="-mavx512f -mavx512dq" ;;
        esac
        $compile $flags -c "$source" -o "$directory/$(basename "$source" .c).o" || return 255
    done
}
export -f compile_files

# Shuffled, so that the shares of the processors are alike.
printf '%s\0' $files | shuf -z --random-source=LICENSE | xargs -0 -n 8 -P "$(nproc)" bash -c 'compile_files "$@"' _
