/* SPDX-License-Identifier: Apache-2.0 */
/* A place on Earth as people write it on the command line, and the attitude of a unit there. */
#ifndef IMUKIT_PLACE_TEXT_H
#define IMUKIT_PLACE_TEXT_H

#include "command.h"

#include "imukit/earth.h"

/* "34.2 deg, 108.9 deg, 380 m". Messages speak of --position. @return -1 or the exit code */
int place_parse(const char *text, imk_geodetic *place);

/* Whether --latitude, --height, --roll, --pitch and --yaw are those of a unit on Earth. SI.
 * @return -1 or the exit code */
int place_check_rest(double latitude, double height, const double attitude[3]);

#endif
