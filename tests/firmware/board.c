/* SPDX-License-Identifier: Apache-2.0 */
/* Start, output and end of a program on the board of board.ld, through semihosting: the processor
 * asks the debugger, which is qemu, by a break with a number. */
#include "board.h"

extern unsigned char stack_top[];
int main(void);
void reset(void);

/* ARM, "Semihosting for AArch32 and AArch64". */
enum { SYS_WRITE0 = 0x04, SYS_EXIT_EXTENDED = 0x20, APPLICATION_EXIT = 0x20026 };

static void ask(uint32_t operation, const void *parameter)
{
    register uint32_t r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = parameter;
    __asm__ volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
}

void board_print(const char *text)
{
    ask(SYS_WRITE0, text);
}

void board_print_number(uint32_t number)
{
    char text[12];
    int at = 11;
    text[at] = '\0';
    do
        text[--at] = (char)('0' + number % 10);
    while (number /= 10);
    board_print(text + at);
}

/* The system timer counts down at 25 MHz. With qemu's -icount shift=0 an instruction takes 1 ns. */
#define SYST_CSR (*(volatile uint32_t *)0xE000E010)
#define SYST_RVR (*(volatile uint32_t *)0xE000E014)
#define SYST_CVR (*(volatile uint32_t *)0xE000E018)
enum { TICK_INSTRUCTIONS = 40, TIMER_MASK = 0xFFFFFF };

uint32_t board_instructions(void)
{
    static const uint32_t enabled_by_processor_clock = 5;
    if (!(SYST_CSR & 1)) {
        SYST_RVR = TIMER_MASK;
        SYST_CVR = 0;
        SYST_CSR = enabled_by_processor_clock;
    }
    return ((0u - SYST_CVR) & TIMER_MASK) * TICK_INSTRUCTIONS;
}

void reset(void)
{
    /* Full access to coprocessors 10 and 11: the floating-point unit. */
    *(volatile uint32_t *)0xE000ED88 |= 0xFu << 20;
    __asm__ volatile("dsb\n isb");
    const uint32_t ended[2] = {APPLICATION_EXIT, (uint32_t)main()};
    ask(SYS_EXIT_EXTENDED, ended);
    for (;;) {
    }
}

static void stop(void)
{
    static const uint32_t ended[2] = {APPLICATION_EXIT, 3};
    board_print("stopped by a fault\n");
    ask(SYS_EXIT_EXTENDED, ended);
    for (;;) {
    }
}

/* What the processor reads first: the stack, then where to begin and where to go when it fails. */
__attribute__((section(".vectors"), used)) static const struct {
    const void *stack;
    void (*handler[15])(void);
} vectors = {stack_top, {reset, stop, stop, stop, stop, stop}};
