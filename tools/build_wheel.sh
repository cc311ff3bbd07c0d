#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Builds the wheel of the Python package: $BUILD/dist/imukit-VERSION-cp311-abi3-PLATFORM.whl. It is
# built with Debian's Python, and holds the C library; other interpreters from 3.11 on import it, too.
set -eu
cd "$(dirname "$0")/.."
build=$(cd "${BUILD:-build}" && pwd)
rm -rf "$build/dist" "$build/wheel"
mkdir -p "$build/dist" "$build/wheel"
cd python
IMUKIT_BUILD=$build CC="${CC:-cc}" /usr/bin/python3 -W ignore setup.py -q \
    build --build-base "$build/wheel" egg_info --egg-base "$build/wheel" \
    bdist_wheel --dist-dir "$build/dist" >"$build/wheel.log" 2>&1 || { cat "$build/wheel.log"; exit 1; }
if grep -q '\.[ch]:[0-9:]* warning:' "$build/wheel.log"; then
    cat "$build/wheel.log"
    exit 1
fi
ls "$build"/dist/*.whl
