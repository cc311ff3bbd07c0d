#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# make demo: two hours of a sensor we know, identified as if we did not.
# BUILD is the build directory (default: build), DEVICE a name from `imukit devices`.
set -eu
imukit=${BUILD:-build}/imukit
directory=${BUILD:-build}/demo
device=${DEVICE:-AHRS}
mkdir -p "$directory"

say() { printf '\n%s\n' "$*"; }

say "1. Simulate two hours of the catalogue's \"$device\" unit at rest, 100 samples a second:"
say "   $imukit simulate $device --rate 100Hz --duration 2h --seed 1 -o $directory/static.csv"
"$imukit" simulate "$device" --rate 100Hz --duration 2h --seed 1 -o "$directory/static.csv"
ls -l "$directory/static.csv" | awk '{printf "   %.0f MB of CSV\n", $5 / 1e6}'

say "2. Identify its noise from that log, and compare with the truth:"
say "   $imukit identify $directory/static.csv --truth $device --twin \\
     -o $directory/model.yaml --report $directory/report.html"
echo
"$imukit" identify "$directory/static.csv" --truth "$device" --twin \
    -o "$directory/model.yaml" --report "$directory/report.html" >"$directory/identify.txt"
sed -n '/^channel/,/^$/p' "$directory/identify.txt"

echo "The page with verdict, parameters, Allan plots and model: $directory/report.html"
echo "The model file: $directory/model.yaml    The whole output: $directory/identify.txt"
say "Now with a log of your own (the sensor at rest, an hour or more):"
echo "   $imukit identify LOG.csv -o model.yaml --report report.html"
echo "If units or sample rate are not in the file, the message names the option to add."
