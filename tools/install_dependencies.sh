#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Installs the Debian packages of the groups named (all when none is) that are missing.
#
#     tools/install_dependencies.sh [build|run|test|check|bench|fuzz|octave|web|npm|mpi]...
#
# Nothing is missing: says nothing and asks apt nothing. Otherwise it installs as root or through
# sudo, or prints the one line to run. On systems without dpkg it leaves the matter to CMake.
set -eu

list=$(dirname "$0")/packages.txt
groups=${*:-"build run test check bench fuzz"}

wanted=$(awk -v groups="$groups" '
    BEGIN { count = split(groups, name, " "); for (i = 1; i <= count; i++) want[name[i]] = 1 }
    /^#/ || NF == 0 { next }
    want[$1] && !seen[$2]++ { print $2 }' "$list")

if ! command -v dpkg-query >/dev/null 2>&1; then
    echo "Not a Debian system: if the build stops, install what corresponds to:" $wanted >&2
    exit 0
fi

missing=
for package in $wanted; do
    state=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null || true)
    [ "$state" = installed ] || missing="$missing $package"
done
[ -n "$missing" ] || exit 0

install="apt-get install -y --no-install-recommends$missing"
if [ "$(id -u)" = 0 ]; then
    sudo=
elif command -v sudo >/dev/null 2>&1 && { [ -t 0 ] || sudo -n true 2>/dev/null; }; then
    sudo="sudo"
else
    echo "Missing packages. Run this as root, then the same make command again:" >&2
    echo "    $install" >&2
    exit 1
fi

echo "Installing:$missing" >&2
export DEBIAN_FRONTEND=noninteractive
log=$(mktemp)
trap 'rm -f "$log"' EXIT
# A stale package index is the usual reason for a package not to be found, so it is renewed first;
# if that fails (no network, a local mirror), the index at hand may still do.
if ! { $sudo apt-get update && $sudo env DEBIAN_FRONTEND=noninteractive $install; } \
        >"$log" 2>&1 </dev/null &&
   ! $sudo env DEBIAN_FRONTEND=noninteractive $install >"$log" 2>&1 </dev/null; then
    tail -n 20 "$log" >&2
    echo "The installation failed. To try by hand:" >&2
    echo "    ${sudo:+$sudo }apt-get update && ${sudo:+$sudo }$install" >&2
    exit 1
fi
