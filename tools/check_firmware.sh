#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# The C code of `imukit compensate --emit-c` on the processors it is for: compiled without a warning
# for a Cortex-M4F, and in fixed point for a Cortex-M0; run by qemu, where 10 000 samples agree with
# imk_correct() within the stated bound; counted. The code for the M0 runs on the M4, whose
# instructions contain the M0's. The streaming Allan variances of the library run there too.
set -eu
cd "$(dirname "$0")/.."
out=build-check/firmware
build=${BUILD:-build}
rm -rf "$out"
mkdir -p "$out"
tools/release_build.sh imukit-command

warnings="-std=c99 -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wdouble-promotion -Werror"
m4="-mcpu=cortex-m4 -mthumb -mfpu=fpv4-sp-d16 -mfloat-abi=hard"
m0="-mcpu=cortex-m0 -mthumb"
board="-std=gnu17 -Wall -Wextra -Werror -Itests/firmware"
emulate="timeout 60 qemu-system-arm -M mps2-an386 -nographic -icount shift=0
    -semihosting-config enable=on,target=native"
status=0
complain() { echo "$*"; status=1; }

# unit DIR PROCESSOR LEVEL READING VALUE: compile, look at, link and run the code in DIR; sets flash,
# stack, instructions.
unit() {
    local dir=$1 processor=$2 level=$3 program=$1/$3
    arm-none-eabi-gcc $processor $warnings -$level -fstack-usage -c "$dir/unit.c" -o "$program.o"
    read -r flash data bss _ < <(arm-none-eabi-size "$program.o" | tail -n 1)
    stack=$(awk '{ print $(NF - 1) }' "$program.su")
    [ "$data$bss" = 00 ] || complain "$program.o: $data bytes of data, $bss of bss: expected none"
    local undefined
    undefined=$(arm-none-eabi-nm -u "$program.o" | awk '{ print $2 }' | grep -v '^__aeabi_' || true)
    [ -z "$undefined" ] || complain "$program.o needs more than libgcc's __aeabi_:" $undefined
    arm-none-eabi-gcc $processor $board -O2 -I"$dir" -DREADING="$4" -DVALUE="$5" -nostartfiles \
        -T tests/firmware/board.ld tests/firmware/board.c tests/firmware/board_main.c \
        "$dir/unit_test.c" "$program.o" -o "$program.elf"
    answer=$($emulate -kernel "$program.elf" 2>&1) || complain "$program.elf: $answer"
    instructions=$(echo "$answer" | awk '{ print $(NF - 1) }')
    echo "$program: flash $flash B, stack $stack B, $answer"
}

for arithmetic in float double fixed; do
    value=$arithmetic
    [ $arithmetic = fixed ] && value=int32_t
    for model in linear nonlinear; do
        dir=$out/$model-$arithmetic
        "$build/imukit" compensate tests/firmware/$model.yaml --emit-c "$dir" --prefix unit \
            --arithmetic $arithmetic --vectors 10000 2>"$out/emit.log" ||
            { cat "$out/emit.log"; exit 1; }
        reading=$value
        [ $model = linear ] && reading=int32_t
        for level in Os O2; do
            unit "$dir" "$m4" $level "$reading" $value
            # What the project promises of single precision, six axes and the third order.
            if [ $model-$arithmetic = linear-float ]; then
                [ "$flash" -le 2048 ] || complain "$dir: $flash bytes of flash, more than 2048"
                [ "$instructions" -le 250 ] || complain "$dir: $instructions instructions, not 250"
                single="$flash B and $instructions instructions ($level)"
            fi
        done
        if [ $arithmetic = fixed ]; then
            mkdir -p "$dir/m0"
            cp "$dir"/unit* "$dir/m0/"
            unit "$dir/m0" "$m0" Os "$reading" $value
        fi
    done
done

# That a wrong constant is found is checked too, or the runs would prove nothing.
mkdir -p "$out/wrong"
cp "$out/linear-float/unit.h" "$out/linear-float/unit_test.c" "$out/wrong/"
# The scale of an accelerometer cut off after four digits: about 1e-5 off.
sed '/force\[0\] per accel\[0\]/s/\(0x1\.[0-9a-f]\{4\}\)[0-9a-f]*/\1/' \
    "$out/linear-float/unit.c" >"$out/wrong/unit.c"
! cmp -s "$out/linear-float/unit.c" "$out/wrong/unit.c" || complain "the constant to spoil is gone"
arm-none-eabi-gcc $m4 $board -O2 -I"$out/wrong" -DREADING=int32_t -DVALUE=float -nostartfiles \
    -T tests/firmware/board.ld tests/firmware/board.c tests/firmware/board_main.c \
    "$out/wrong/unit_test.c" "$out/wrong/unit.c" -o "$out/wrong.elf"
if $emulate -kernel "$out/wrong.elf" >"$out/wrong.log" 2>&1; then
    complain "a wrong constant was not noticed"
fi

# The streaming Allan variances of the library itself: the same bits on the device as here.
sources="src/identify/allan/allan_stream.c src/identify/allan/allan_stream_join.c"
gcc -DSTREAM_HOST -std=gnu17 -O2 -ffp-contract=off -Iinclude -Isrc tests/firmware/stream_main.c \
    $sources -lm -o "$out/stream_host"
arm-none-eabi-gcc $m4 $board -O2 -ffp-contract=off -Iinclude -Isrc -nostartfiles \
    -T tests/firmware/board.ld tests/firmware/board.c tests/firmware/stream_main.c $sources \
    -lm -o "$out/stream.elf"
"$out/stream_host" >"$out/stream_host.txt" || complain "the streaming Allan variances failed here"
$emulate -kernel "$out/stream.elf" >"$out/stream_device.txt" 2>&1 || complain "$out/stream.elf failed"
grep -v instructions "$out/stream_device.txt" | cmp - "$out/stream_host.txt" ||
    complain "the streaming Allan variances differ on the device"
echo "streaming Allan variances: $(tail -n 1 "$out/stream_device.txt")"

[ $status = 0 ] && echo "float, third order, six axes on a Cortex-M4F: $single a sample"
exit $status
