/* SPDX-License-Identifier: Apache-2.0 */
/** @file aid_text.h
 *  Aids (aiding.h) in one line of text, such as
 *
 *      gnss position 1 m, velocity 0.05 m/s at 1 Hz until 600 s, lever arm 1 0 -2 ± 0.05 m
 *
 *  Words, in any order after the first quantity; commas may stand between them:
 *  - gnss, gps, barometer, compass, …: a name at the start, without effect;
 *  - position, velocity, height, heading, zero velocity: 1 sigma of one reading; one number, or
 *    where there are three axes three, for north, east, down. With "horizontal" before it, down is
 *    not measured;
 *  - odometer: one number, along body x; or three, along x, y, z;
 *  - correlated 60 s: the error is a Gauss-Markov process of the stated 1 sigma, beside white noise
 *    of a tenth of it. Right behind a quantity it is of that one, behind a comma of all;
 *  - at 1 Hz, every 10 s: how often; default 1 Hz;
 *  - from 30 s, until 600 s: first and last reading; default after the first interval, and without
 *    end;
 *  - lever arm 1 0 -2 ± 0.05 m: from the unit to what is measured, body axes. */
#ifndef IMUKIT_AID_TEXT_H
#define IMUKIT_AID_TEXT_H

#include "imukit/aiding.h"

IMK_BEGIN_C

/** White noise beside a correlated error, as a part of its sigma. */
#define IMK_AID_TEXT_WHITE 0.1

/** Read a line.
 *  @param aid    room for IMK_AIDS_MAX
 *  @param count  set to the number of aids, one for each quantity
 *  @return IMK_ERROR_SYNTAX, IMK_ERROR_EMPTY, IMK_ERROR_RANGE, errors of imk_quantity_parse() and
 *          imk_aid_validate() */
IMK_API imk_status imk_aid_parse(const char *text, imk_aid aid[IMK_AIDS_MAX], size_t *count,
                                 imk_error *error);

IMK_END_C
#endif
