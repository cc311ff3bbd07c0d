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

extension() { # NAME INTERPRETER: the package with an extension of its own in $build/python-NAME
    (cd python && IMUKIT_BUILD=$build "$2" -W ignore setup.py -q build_ext --build-lib "$build/python-$1" \
        --build-temp "$build/python-$1-objects") >"$build/python-$1.log" 2>&1 ||
        { cat "$build/python-$1.log"; exit 1; }
    cp -r python/imukit/. "$build/python-$1/imukit/"
}

extension debug /usr/bin/python3-dbg
(cd python/tests && PYTHONPATH=$build/python-debug /usr/bin/python3-dbg count_references.py 20)

IMUKIT_SANITIZE=1 extension sanitized /usr/bin/python3
# Leaks of the interpreter itself are not ours; the debug interpreter counts.
(cd python/tests && ASAN_OPTIONS=detect_leaks=0 PYTHONPATH=$build/python-sanitized \
    LD_PRELOAD="$(cc -print-file-name=libasan.so) $(cc -print-file-name=libubsan.so)" \
    /usr/bin/python3 -m unittest -q) 2>"$build/python-sanitized.log" || { cat "$build/python-sanitized.log"; exit 1; }
echo "sanitized: $(sed -n 's/^Ran \(.* tests\) .*/\1/p' "$build/python-sanitized.log")"
