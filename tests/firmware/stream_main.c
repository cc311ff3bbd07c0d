/* SPDX-License-Identifier: Apache-2.0 */
/* The streaming Allan variances on the board and, with STREAM_HOST, on the machine that built them:
 * both print the same bits, high and low word of each variance. On the board the last line says
 * what a sample costs. */
#include "imukit/allan_stream.h"

#include <string.h>

#ifdef STREAM_HOST
#include <stdio.h>
static void board_print(const char *text)
{
    fputs(text, stdout);
}
static void board_print_number(uint32_t number)
{
    printf("%u", (unsigned)number);
}
#else
#include "board.h"
#endif

enum { SAMPLES = 4096, BLOCK = 64 };

/* An accelerometer at rest: gravity and noise of some mg, of a linear congruential generator. */
static double sample(void)
{
    static uint32_t state = 1;
    state = state * 1664525 + 1013904223;
    return 9.80665 + (double)(int32_t)state * 1e-11;
}

int main(void)
{
    static imk_allan_stream stream;
    static double block[BLOCK];
    imk_allan_stream_start(&stream, 0);
    uint32_t spent = 0;
    for (int i = 0; i < SAMPLES; i += BLOCK) {
        for (int k = 0; k < BLOCK; k++)
            block[k] = sample();
#ifndef STREAM_HOST
        const uint32_t start = board_instructions();
#endif
        imk_allan_stream_add(&stream, BLOCK, block);
#ifndef STREAM_HOST
        spent += board_instructions() - start;
#endif
    }
    imk_allan_stream_point points[IMK_ALLAN_STREAM_FACTORS];
    const size_t count = imk_allan_stream_points(&stream, points);
    for (size_t i = 0; i < count; i++) {
        uint64_t bits;
        memcpy(&bits, &points[i].variance, sizeof bits);
        board_print_number((uint32_t)points[i].m);
        board_print(" ");
        board_print_number((uint32_t)(bits >> 32));
        board_print(" ");
        board_print_number((uint32_t)bits);
        board_print("\n");
    }
    if (spent > 0) {
        board_print_number(spent / SAMPLES);
        board_print(" instructions a sample\n");
    }
    return count < 10;
}
