/* SPDX-License-Identifier: Apache-2.0 */
/* What a program on the emulated board can do besides computing. */
#ifndef IMUKIT_TESTS_BOARD_H
#define IMUKIT_TESTS_BOARD_H

#include <stdint.h>

void board_print(const char *text);
void board_print_number(uint32_t number);
/* Instructions since the first call, modulo 671 million, in steps of 40. */
uint32_t board_instructions(void);

#endif
