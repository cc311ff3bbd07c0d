/* SPDX-License-Identifier: Apache-2.0 */
/** @file standing_start.h
 *  What the gyros of a unit read while it stands before navigation: their turn-on biases.
 *
 *  The mean reading r of a unit at rest is the Earth's rate in its axes, w, its bias and noise.
 *  With the attitude known but for an error e (drift.h), r - w(estimated) = b - C^T [w x] e + n
 *  measures the bias. Of a unit that found north by its gyros the component to the east is zero by
 *  construction and says nothing; that to the north and down do. Where the biases hide the Earth's
 *  rotation, the heading is one of a circle, and only how it goes with the biases is known.
 *  Equations: docs/theory/navigation-filter.md. */
#ifndef IMUKIT_STANDING_START_H
#define IMUKIT_STANDING_START_H

#include "imukit/navigation_filter.h"

IMK_BEGIN_C

/** Readings of the gyros at rest, over the time just before navigation. */
typedef struct imk_standing_start {
    imk_vector3 rate;      /**< mean reading, body axes [rad/s] */
    double time;           /**< over this time [s] */
    double rotation_sigma; /**< 1 sigma of the unit's own mean rate, such as of a vehicle that sways
                              [rad/s] */
    bool heading_found;    /**< the heading is that of the same readings */
} imk_standing_start;

/** Take the biases of the gyros from the readings, right after imk_navigation_filter_start() with
 *  settings of imk_navigation_filter_describe() and imk_navigation_filter_aligned(): biases, their
 *  covariance and that with the attitude. It is no update of the counts.
 *  @return false: the readings are beyond what the settings explain (probability below 1e-6); they
 *          are taken all the same, with constant biases of their size */
IMK_API bool imk_navigation_filter_stood(imk_navigation_filter *filter,
                                         const imk_standing_start *stood);

/** How well the heading is known from gyros with a bias, when the bias may be larger than the
 *  Earth's rotation. With a horizontal mean reading of size h, the Earth's horizontal rate w and
 *  independent biases of 1 sigma s, the density of the heading about that of the reading is
 *  proportional to exp(k cos(heading)), k = h w/s^2 (von Mises) [MARDIA2000].
 *  @return root mean square of the heading [rad]: s/w for small s, up to pi/sqrt(3) */
IMK_API double imk_heading_spread(double reading, double earth, double sigma);

IMK_END_C
#endif
