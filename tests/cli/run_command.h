/* SPDX-License-Identifier: Apache-2.0 */
/* Runs the command as a user would and keeps what it printed. The binary under test is
 * IMUKIT_COMMAND, given by the build, or `imukit` beside the test program. Every test program works
 * in an empty directory of its own, so that what a command leaves behind can be seen. */
#ifndef IMUKIT_TESTS_RUN_COMMAND_H
#define IMUKIT_TESTS_RUN_COMMAND_H

#define _DEFAULT_SOURCE
#include "check.h"
#include "imukit/figure_file.h"

#include <jansson.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

enum { TEXT_SIZE = 1 << 20 };
extern char command[4096];
/** Where the tests of a program work: made by set_up, and to be empty again in tear_down. */
extern char directory[];
extern char out[TEXT_SIZE], err[TEXT_SIZE];

int set_up(void **state);
int tear_down(void **state);

/* Run a shell line in which $I is the command; standard output and error go to out and err. */
int run(const char *line);

void read_text(const char *path, char *text);
void put(const char *path, const char *text);

/* Files in the working directory; they are removed. */
size_t sweep(void);

void check_contains(const char *text, const char *part, const char *line);

/* A line that must end with this code and say exactly this on standard error. */
void check_message(const char *line, int code, const char *message);

#define TRY_MAIN "Try: imukit --help\n"
#define TRY(verb) "Try: imukit " verb " --help\n"

/* 1000 rows at 100 Hz of one gyro. */
void write_good(void);

/* Members of a sensor in a model file that state its other terms to be 0; in front of `}`. */
#define NO_OTHER_TERM(white, rate, walk)                                                           \
    "scale_factor: {repeatability: 0 ppm}, misalignment: 0 mrad, noise: {" white ", "              \
    "bias_instability: 0 " rate ", " walk "}"
#define NO_OTHER_GYRO_TERM_THAN(white)                                                             \
    NO_OTHER_TERM("angle_random_walk: " white, "deg/h", "rate_random_walk: 0 deg/h/sqrt(h)")       \
    ", g_sensitivity: [0 0 0 deg/h/g, 0 0 0 deg/h/g, 0 0 0 deg/h/g]"                               \
    ", g2_sensitivity: [0 0 0 0 0 0 deg/h/g^2, 0 0 0 0 0 0 deg/h/g^2, 0 0 0 0 0 0 deg/h/g^2]"
#define NO_OTHER_ACCEL_TERM_THAN(white)                                                            \
    NO_OTHER_TERM("velocity_random_walk: " white, "ug", "acceleration_random_walk: 0 ug/sqrt(h)")  \
    ", nonlinearity: {k2: 0 ppm/g}"
#define NO_OTHER_GYRO_TERM NO_OTHER_GYRO_TERM_THAN("0 deg/sqrt(h)")
#define NO_OTHER_ACCEL_TERM NO_OTHER_ACCEL_TERM_THAN("0 m/s/sqrt(h)")

#endif
