#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Fetches the sources that web/sources.txt lists, as Debian has them, checks and unpacks them:
#
#     tools/fetch_web_sources.sh FOLDER
#
# What is there already is not fetched again, so a second build needs no network. A list of packages
# of its own: that of the system seldom knows sources, and needs root.
set -eu
cd "$(dirname "$0")/.."
list=$(pwd)/web/sources.txt
mkdir -p "$1/lists/partial" "$1/archives/partial"
cd "$1"

wanted() { awk '!/^#/ && NF { print $4 "  " $3 }' "$list"; }
if ! wanted | sha256sum --check --status 2>/dev/null; then
    echo "deb-src [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg]" \
        "${DEBIAN_MIRROR:-http://deb.debian.org/debian} bookworm main" >sources.list
    ask=(apt-get -q -o "Dir::Etc::SourceList=$PWD/sources.list" -o Dir::Etc::SourceParts=/dev/null
        -o "Dir::State::Lists=$PWD/lists" -o "Dir::Cache=$PWD" -o "APT::Sandbox::User=$(id -un)")
    { "${ask[@]}" update && "${ask[@]}" source --download-only --tar-only \
        $(awk '!/^#/ && NF { print $1 }' "$list"); } >fetch.log 2>&1 ||
        { cat fetch.log; echo "Sources of the page cannot be fetched (above)."; exit 1; } >&2
    wanted | sha256sum --check --quiet >&2 ||
        { echo "A fetched source is not the one that web/sources.txt names." >&2; exit 1; }
fi
if ! cmp -s "$list" unpacked.txt; then
    rm -rf unpacked && mkdir unpacked
    for file in $(awk '!/^#/ && NF { print $3 }' "$list"); do
        tar -C unpacked --no-same-owner -xf "$file"
    done
    cp "$list" unpacked.txt
fi
