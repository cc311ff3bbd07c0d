#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Builds the Python package into a folder, for use from there: tools/build_package.sh FOLDER PYTHON.
# Only what has changed is compiled.
set -eu
cd "$(dirname "$0")/.."
build=$(cd "${BUILD:-build}" && pwd)
cd python
IMUKIT_BUILD=$build "$2" -W ignore setup.py -q build_ext --build-lib "$1" --build-temp "$1-objects" \
    >"$1.log" 2>&1 || { cat "$1.log"; exit 1; }
rm -rf "$1"/imukit/*.py "$1/imukit/__pycache__"
cp imukit/*.py* imukit/py.typed "$1/imukit/"
