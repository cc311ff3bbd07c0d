/* SPDX-License-Identifier: Apache-2.0 */
/* On the board: the self-test of unit_test.c, and the instructions of a sample. READING and VALUE
 * are the types of unit_correct(). Ends with 0 when every sample is right. */
#include "board.h"
#include "unit.h"

enum { CALLS = 1000 };

/* The loop with and without the call: the difference counts arguments and call too. */
static uint32_t instructions_of(int calls)
{
    static const READING gyro[3] = {(READING)100, (READING)-200, (READING)300};
    static const READING accel[3] = {(READING)-100, (READING)50, (READING)10};
    VALUE rate[3], force[3];
    unsigned flags = 0;
    const uint32_t start = board_instructions();
    for (int i = 0; i < CALLS; i++) {
        __asm__ volatile("" ::: "memory");
        if (calls)
            flags |= unit_correct(gyro, accel, (VALUE)20, rate, force);
    }
    const uint32_t end = board_instructions();
    __asm__ volatile("" ::"r"(rate), "r"(force), "r"(flags) : "memory");
    return end - start;
}

int main(void)
{
    const unsigned long wrong = unit_self_test();
    (void)board_instructions();
    const uint32_t empty = instructions_of(0), full = instructions_of(1);
    board_print_number((uint32_t)wrong);
    board_print(" wrong, ");
    board_print_number((full - empty + CALLS / 2) / CALLS);
    board_print(" instructions\n");
    return wrong != 0;
}
