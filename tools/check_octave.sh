#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# The functions of GNU Octave: they are built, agree with the command to the last bit, refuse what is
# wrong and leave no file behind Ctrl-C; the file for MATLAB's imuSensor makes the noise of the model;
# the examples of docs/matlab.md run. Real logs are expected in ../shared/data.
set -eu
cd "$(dirname "$0")/.."
build=$(realpath "${BUILD:-build}")
out=build-check/octave
rm -rf "$out"
mkdir -p "$out/build"
tools/release_build.sh octave imukit-command

octave="timeout 300 octave-cli --no-gui --quiet --no-init-file --no-history"
run() { # FILE ARGUMENT...
    $octave "$@" 2>"$out/run.log" </dev/null || { cat "$out/run.log"; exit 1; }
}
run matlab/test_gateway.m "$build" ../shared/data
run matlab/test_imusensor.m "$build"

# Ctrl-C within a simulation leaves no temporary file.
mkdir "$out/tmp"
TMPDIR=$PWD/$out/tmp $octave --eval "addpath ('$build/octave');
    imukit_simulate ('AHRS', 'rate', 1000, 'duration', 20000);" >"$out/interrupted.log" 2>&1 </dev/null &
for _ in $(seq 200); do
    [ -z "$(ls "$out"/tmp/*/ 2>/dev/null)" ] || break
    sleep 0.05
done
[ -n "$(ls "$out/tmp")" ] || { echo "no simulation to interrupt"; exit 1; }
kill -INT $!
if wait $!; then echo "the simulation ended before Ctrl-C"; exit 1; fi
[ -z "$(ls -A "$out/tmp")" ] || { echo "Ctrl-C leaves $(ls "$out/tmp")"; exit 1; }

# The page has a folder of its own, which looks like the root of the repository.
ln -s "$build/imukit" "$build/octave" "$out/build/"
awk '/^<!-- not run: tools\/check octave runs it -->$/ { due = 1; next }
     due && /^```$/ { due = inside = 0; next }
     inside { print }
     due && /^```matlab$/ { inside = 1 }' docs/matlab.md >"$out/page.m"
[ "$(wc -l <"$out/page.m")" -gt 20 ] || { echo "docs/matlab.md has no examples"; exit 1; }
(cd "$out" && $octave page.m) >"$out/page.log" 2>&1 </dev/null || { tail -n 20 "$out/page.log"; exit 1; }
echo "$(grep -c . "$out/page.m") lines of docs/matlab.md"
