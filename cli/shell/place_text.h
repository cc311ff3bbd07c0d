/* SPDX-License-Identifier: Apache-2.0 */
/* A place on Earth as people write it on the command line. */
#ifndef IMUKIT_PLACE_TEXT_H
#define IMUKIT_PLACE_TEXT_H

#include "command.h"

#include "imukit/earth.h"

/* "34.2 deg, 108.9 deg, 380 m". Messages speak of --position. @return -1 or the exit code */
int place_parse(const char *text, imk_geodetic *place);

#endif
