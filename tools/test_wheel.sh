#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Tests the wheel in $BUILD/dist: unpacked into an empty folder, with NumPy where the interpreter has
# it, and without. Debian's interpreter runs all tests; each other from 3.11 on that this machine has
# runs those of arrays, faults and sensors, which do what depends on the interpreter.
set -eu
cd "$(dirname "$0")/.."
build=$(cd "${BUILD:-build}" && pwd)
wheel=$(ls "$build"/dist/imukit-*-cp311-abi3-linux_*.whl)
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT

test_with() { # INTERPRETER NUMBER
    some="test_allan test_faults test_sensor"
    if [ "$2" = 1 ]; then some=; fi
    "$1" -m zipfile -e "$wheel" "$place/$2"
    for numpy in with without; do
        if [ $numpy = without ]; then
            mkdir -p "$place/none"
            echo 'raise ImportError("left out by the tests")' >"$place/none/numpy.py"
            path="$place/none:$place/$2"
        else
            "$1" -c 'import numpy' 2>/dev/null || continue
            path="$place/$2"
        fi
        (cd python/tests && PYTHONPATH=$path "$1" -W error::ResourceWarning -m unittest -q $some) \
            >"$place/log" 2>&1 || { cat "$place/log"; echo "failed: $1 $numpy NumPy"; exit 1; }
        echo "$1 ($("$1" -V)), $numpy NumPy: $(sed -n 's/^Ran \(.* tests\) .*/\1/p' "$place/log")"
    done
}

number=0 seen=
for interpreter in /usr/bin/python3 /usr/bin/python3.[0-9]* /usr/local/bin/python3.[0-9]* \
    "$HOME"/.pyenv/versions/*/bin/python3; do
    case $interpreter in *config | *gdb.py | *dbg) continue ;; esac
    [ -x "$interpreter" ] || continue
    "$interpreter" -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null || continue
    real=$(readlink -f "$interpreter")
    case " $seen " in *" $real "*) continue ;; esac
    seen="$seen $real"
    number=$((number + 1))
    test_with "$interpreter" "$number"
done
