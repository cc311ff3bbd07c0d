#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Makes the page, web/index.html in the build folder:
#
#     tools/build_web.sh           as it is published: optimised as a whole, which takes a minute
#     tools/build_web.sh --quick   a page that is larger and does the same (tools/check web)
set -eu
cd "$(dirname "$0")/.."
build=$(realpath -m "${BUILD:-build}")
small=ON objects=$build/web-objects-small
[ "${1:-}" != --quick ] || small=OFF objects=$build/web-objects
tools/fetch_web_sources.sh "$build/web-sources"
mkdir -p "$objects"
{ cmake -S web -B "$objects" -D CMAKE_TOOLCHAIN_FILE="$PWD/web/wasi.cmake" \
    -D IMUKIT_WEB_SOURCES="$build/web-sources/unpacked" -D IMUKIT_WEB_SMALL=$small &&
    cmake --build "$objects" -j "$(nproc)"; } >"$objects/build.log" 2>&1 &&
    ! grep -q 'warning:' "$objects/build.log" || { cat "$objects/build.log"; exit 1; } >&2
node web/build.mjs "$objects/imukit.wasm" "$build/web"
