#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Every C and C++ file is as clang-format leaves it.
set -eu
cd "$(dirname "$0")/.."
mapfile -t files < <(find include src cli matlab python web/core tests bench fuzz examples -name '*.[ch]' -o -name '*.cpp')
if ! printf '%s\0' "${files[@]}" | xargs -0 -P "$(nproc)" -n 50 clang-format --dry-run -Werror; then
    echo "to mend: clang-format -i FILE"
    exit 1
fi
echo "${#files[@]} files"
