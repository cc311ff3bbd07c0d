#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Every public header compiles alone, and all compile together, as C17 and as C++.
set -u
cd "$(dirname "$0")/.."
status=0
headers=$(cd include && ls imukit/*.h)
compile() { # TEXT
    printf '%s\n' "$1" | gcc -std=c17 -Wall -Wextra -Wpedantic -Werror -Iinclude -fsyntax-only \
        -x c - || status=1
    printf '%s\n' "$1" | g++ -std=c++17 -Wall -Wextra -Wpedantic -Werror -Iinclude -fsyntax-only \
        -x c++ - || status=1
}
for header in $headers; do
    compile "#include \"$header\""
done
compile "$(printf '#include "%s"\n' $headers)"
echo "$(echo $headers | wc -w) headers"
exit $status
