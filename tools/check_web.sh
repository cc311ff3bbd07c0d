#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# The page computes what the command computes, and its screens work in a browser. It is compiled
# quickly here; make test-web tests it as it is published, and more.
set -eu
cd "$(dirname "$0")/.."
build=${BUILD:-build}
for script in web/page/*.js web/page/screens/*.js web/*.mjs web/test/*.mjs; do
    node --check "$script"
done
tools/release_build.sh imukit-command
tools/build_web.sh --quick
node --no-warnings --test web/test/*.test.mjs
echo "the page: $(gzip -9c "$build/web/index.html" | wc -c | awk '{ print int($1 / 1000) }') kB with gzip;" \
    "$(ls web/test/*.test.mjs | wc -l) files of tests"
