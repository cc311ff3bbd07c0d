#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# The Python package: its types, its tests as a wheel with every interpreter, under the address and
# undefined-behaviour sanitizers, and with a debug interpreter, which counts references.
set -eu
cd "$(dirname "$0")/.."
build=$(cd "${BUILD:-build}" && pwd) # made by `make test`
mypy --strict --cache-dir "$build/python-types" python/imukit
BUILD=$build tools/build_wheel.sh >/dev/null
BUILD=$build tools/test_wheel.sh

BUILD=$build tools/build_package.sh "$build/python-debug" /usr/bin/python3-dbg
(cd python/tests && PYTHONPATH=$build/python-debug /usr/bin/python3-dbg count_references.py 4)

IMUKIT_SANITIZE=1 BUILD=$build tools/build_package.sh "$build/python-sanitized" /usr/bin/python3
# Leaks of the interpreter itself are not ours; the debug interpreter counts.
(cd python/tests && ASAN_OPTIONS=detect_leaks=0 PYTHONPATH=$build/python-sanitized \
    LD_PRELOAD="$(cc -print-file-name=libasan.so) $(cc -print-file-name=libubsan.so)" \
    /usr/bin/python3 -m unittest -q) 2>"$build/python-sanitized.log" || { cat "$build/python-sanitized.log"; exit 1; }
echo "sanitized: $(sed -n 's/^Ran \(.* tests\) .*/\1/p' "$build/python-sanitized.log")"
