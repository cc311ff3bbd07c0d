#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Write src/base/decimal/decimal_powers.c: 10^e as 128-bit significands, rounded down, with exact integers.

    make_decimal_powers.py FILE          writes the table
    make_decimal_powers.py --check FILE  compares it with what would be written, exit 1 if different

It also proves, over the whole range, the integer formula of decimal_internal.h for
floor(log2(10^e)), and that exactly the powers 0 ... 55 are exact.
"""
import sys

FIRST, LAST = -342, 341  # parse needs -342 ... 308, "%.17g" of the smallest double 340


def floor_log2(exponent):
    """floor(log2(10^exponent)), exactly."""
    if exponent >= 0:
        return (10**exponent).bit_length() - 1
    return -((10**-exponent - 1).bit_length())


def significand(exponent):
    """floor(10^e 2^(127 - floor(log2 10^e))), and whether it is exact."""
    shift = 127 - floor_log2(exponent)
    numerator, denominator = 10 ** max(exponent, 0), 10 ** max(-exponent, 0)
    if shift >= 0:
        numerator <<= shift
    else:
        denominator <<= -shift
    return divmod(numerator, denominator)


def table():
    lines = [
        "/* SPDX-License-Identifier: Apache-2.0 */",
        "/* Powers of ten as 128-bit significands rounded down, the highest bit set:",
        " *",
        " *     10^e = (high 2^64 + low + r) 2^(floor(log2 10^e) - 127),  0 <= r < 1",
        " *",
        f" * for e = {FIRST} ... {LAST}, two in a row; r = 0 for 0 <= e <= 55. Written by",
        " * tools/make_decimal_powers.py. */",
        '#include "decimal_internal.h"',
        "",
        "/* clang-format off */",
        "const imki_decimal_power imki_decimal_powers[IMKI_POWER_LAST - IMKI_POWER_FIRST + 1] = {",
    ]
    powers = []
    for exponent in range(FIRST, LAST + 1):
        value, remainder = significand(exponent)
        assert 1 << 127 <= value < 1 << 128
        assert (remainder == 0) == (0 <= exponent <= 55)
        assert floor_log2(exponent) == ((exponent * 217706 + (2048 << 16)) >> 16) - 2048
        powers.append(f"{{0x{value >> 64:016X}, 0x{value & (1 << 64) - 1:016X}}},")
    for i in range(0, len(powers), 2):
        lines.append(f"    {' '.join(powers[i:i + 2])} /* {FIRST + i} */")
    return "\n".join(lines + ["};", "/* clang-format on */", ""])


def main(arguments):
    if len(arguments) == 2 and arguments[0] == "--check":
        with open(arguments[1], encoding="ascii") as file:
            if file.read() != table():
                sys.exit(f"{arguments[1]} is not what {sys.argv[0]} writes")
    elif len(arguments) == 1 and not arguments[0].startswith("-"):
        with open(arguments[0], "w", encoding="ascii") as file:
            file.write(table())
    else:
        sys.exit(__doc__)


main(sys.argv[1:])
