#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Prints the files of the libraries that the linker takes for these objects, by name, so that a check
# need not compile the others: tools/needed_files.sh OBJECT…
set -eu
cd "$(dirname "$0")/.."
build=${BUILD:-build}
ld -M -o /dev/null -e 0 --unresolved-symbols=ignore-all --allow-multiple-definition "$@" \
    "$build"/libimukit-io.a "$build"/libimukit-physics.a "$build"/libimukit.a | grep -oE '\([a-z0-9_]+\.c\.o\)' | tr -d '()' | sed 's/\.o$//' | sort -u
