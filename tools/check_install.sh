#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# What `make install` leaves works: examples build and run against it through pkg-config (shared and
# static) and find_package (shared and static), from a place it was not configured for.
set -eu
cd "$(dirname "$0")/.."
build=${BUILD:-build}
out=build-check/install
prefix=$PWD/$out/prefix
tools/release_build.sh product
rm -rf "$out"
mkdir -p "$out"
cmake --install "$build" --prefix "$prefix" >/dev/null

library=$(dirname "$(find "$prefix" -name 'libimukit.so')")
for name in imukit imukit-physics imukit-io; do
    objdump -p "$library/lib$name.so" | grep -q "SONAME *lib$name.so.0.1$" ||
        { echo "lib$name.so: the SONAME is not lib$name.so.0.1"; exit 1; }
done

export PKG_CONFIG_PATH=$library/pkgconfig
log=$out/log.csv
gcc -std=c17 examples/simulate_model.c $(pkg-config --cflags --libs imukit-io) \
    -Wl,-rpath,"$library" -lm -o "$out/simulate_shared"
gcc -std=c17 examples/read_log.c $(pkg-config --cflags imukit-io) -Wl,-Bstatic \
    -L"$library" -limukit-io -limukit-physics -limukit -Wl,-Bdynamic $(pkg-config --libs --static imukit-io) \
    -o "$out/read_static"
gcc -std=c17 tests/identity/physics_hash.c $(pkg-config --cflags --libs imukit-physics) \
    -Wl,-rpath,"$library" -lm -o "$out/physics_shared"
"$out/simulate_shared" tactical "$log"
"$out/physics_shared" >/dev/null
"$out/read_static" "$log"
if objdump -p "$out/read_static" | grep 'NEEDED.*imukit'; then
    echo "the program linked with the archives asks for the shared library"
    exit 1
fi

# The examples are a project of their own.
cmake -S examples -B "$out/examples" -DCMAKE_PREFIX_PATH="$prefix" >/dev/null
cmake --build "$out/examples" >/dev/null
ctest --test-dir "$out/examples" --output-on-failure --no-tests=error

mkdir "$out/static"
cat >"$out/static/CMakeLists.txt" <<'END'
cmake_minimum_required(VERSION 3.25)
project(static_user LANGUAGES C)
find_package(imukit 0.1 REQUIRED COMPONENTS static)
add_executable(read_log ${EXAMPLES}/read_log.c)
target_link_libraries(read_log PRIVATE imukit::imukit_io_static)
END
cmake -S "$out/static" -B "$out/static/build" -DCMAKE_PREFIX_PATH="$prefix" \
    -DEXAMPLES="$PWD/examples" >/dev/null
cmake --build "$out/static/build" >/dev/null
"$out/static/build/read_log" "$log" >/dev/null

if [ -x "$build/imukit" ]; then
    "$prefix/bin/imukit" --version
    [ -n "$(find "$prefix" -name 'imukit-simulate.1*')" ] ||
        { echo "no manual page of imukit simulate is installed"; exit 1; }
fi
echo "$(find "$prefix" -type f | wc -l) files installed"
