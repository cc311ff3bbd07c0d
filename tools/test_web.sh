#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# All tests of the page, as it is published: with axe-core, and with a log of 480 MB (make test-web).
# axe-core (Mozilla Public License 2.0) finds what WCAG forbids; npm fetches it into the build folder
# and checks its hash, once.
set -eu
cd "$(dirname "$0")/.."
build=${BUILD:-build}
axe=$build/web-npm
if ! cmp -s web/package-lock.json "$axe/done"; then
    command -v npm >/dev/null || tools/install_dependencies.sh npm
    mkdir -p "$axe"
    cp web/package.json web/package-lock.json "$axe/"
    (cd "$axe" && npm ci --ignore-scripts --no-audit --no-fund --silent)
    cp web/package-lock.json "$axe/done"
fi
tools/build_web.sh
IMUKIT_WASM=$(realpath "$build/web-objects-small/imukit.wasm") IMUKIT_WEB_LARGE=1 \
    node --no-warnings --test web/test/*.test.mjs
