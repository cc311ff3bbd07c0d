#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# The tests of whatever has kernels by instruction set, each forced in turn; one that this machine
# lacks is the default kernel again. Their expected bits are the same for all.
set -eu
cd "$(dirname "$0")/.."
build=${BUILD:-build}
tools/release_build.sh all
# For these the linker takes a kernel.
names=
for test in $(find tests/{base,model,noise,motion,simulate,compensate,navigate} -name 'test_*.c'); do
    ! tools/needed_files.sh "$build/CMakeFiles/imukit-tests.dir/$test.o" |
        grep -qE '_(scalar|portable)\.c' || names+="|$(basename -s .c "$test")"
done
export IMUKIT_TEST_DRAWS=${IMUKIT_TEST_DRAWS:-1000000}
export IMUKIT_TEST_RUNS=${IMUKIT_TEST_RUNS:-20}
for isa in scalar avx2; do
    echo "IMUKIT_ISA=$isa"
    IMUKIT_ISA=$isa ctest --test-dir "$build" --output-on-failure -j "$(nproc)" --no-tests=error \
        -R "^(${names#|})\$"
done
