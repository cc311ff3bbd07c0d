#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Every public header compiles alone, and all compile together, as C17 and as C++.
set -u
cd "$(dirname "$0")/.."
status=0
headers=$(cd include && ls imukit/*.h)
compile() { # COMPILER LANGUAGE STANDARD: each header on standard input; then all
    local flags="-x $2 -std=$3 -Wall -Wextra -Wpedantic -Werror -Iinclude -fsyntax-only /dev/null"
    xargs -P "$(nproc)" -I{} "$1" -include {} $flags <<<"$headers" || status=1
    "$1" $(printf -- '-include %s ' $headers) $flags || status=1
}
compile gcc c c17
compile g++ c++ c++17
echo "$(wc -w <<<"$headers") headers"
exit $status
