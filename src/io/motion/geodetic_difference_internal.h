/* SPDX-License-Identifier: Apache-2.0 */
/* The way from one place to another, without the digits lost between numbers of Earth size. */
#ifndef IMUKI_GEODETIC_DIFFERENCE_INTERNAL_H
#define IMUKI_GEODETIC_DIFFERENCE_INTERNAL_H

#include "imukit/earth.h"

/* Earth-fixed position of `to` less that of `from` [m]: relative error about 1e-15, beside that of
 * the differences of the coordinates themselves. */
imk_vector3 imki_geodetic_difference(imk_geodetic from, imk_geodetic to);

#endif
