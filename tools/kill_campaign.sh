#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# A campaign of many shards, each killed (SIGKILL) at random times and started again until it is
# done, merged, and compared with the undisturbed campaign, byte for byte.
#
#     [BUILD=build] [SHARDS=100] [SEED=1] tools/kill_campaign.sh
set -eu
cd "$(dirname "$0")/.."
command=$(realpath "${BUILD:-build}/imukit")
shards=${SHARDS:-100}
RANDOM=${SEED:-1}
directory=$(mktemp -d)
trap 'rm -rf "$directory"' EXIT
cd "$directory"

drift=("$command" drift AHRS --duration 1min --monte-carlo $((shards * 24)) --seed 3)
"${drift[@]}" --output whole.h5 >whole.txt
killed=0
resumed=0
for ((i = 1; i <= shards; i++)); do
    while true; do
        # From before the first batch of runs to after the last.
        limit=$(printf '0.%03d' $((RANDOM % 200 + 10)))
        code=0
        # The shell has something to say about each process killed, on its own standard error.
        {
            timeout -s KILL "$limit" "${drift[@]}" --shard "$i/$shards" --threads 1 \
                --output "shard-$i.h5" >shard.txt 2>note.txt || code=$?
        } 2>/dev/null
        grep -q 'are there already' note.txt && resumed=$((resumed + 1))
        [ $code = 0 ] && break
        [ $code = 137 ] || { cat note.txt; exit 1; }
        killed=$((killed + 1))
    done
done
"$command" merge shard-*.h5 --output all.h5
cmp whole.h5 all.h5
leftovers=$(find . -name '*.part' | wc -l)
echo "the same bytes after $killed kills; $resumed times runs were found again;" \
    "$leftovers temporary files left by killed processes"
