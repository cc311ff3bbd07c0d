/* SPDX-License-Identifier: Apache-2.0 */
/** @file aiding.h
 *  Aids of an inertial navigator: what other instruments measure of its position, velocity and
 *  attitude, how well, how often and from where on the body.
 *
 *  One description serves the filter that uses an aid (navigation_filter.h) and the analysis of
 *  what the filter does not know of it: the filter may be given another description than the
 *  truth. An instrument that measures several quantities, such as position and velocity of a GNSS
 *  receiver, is several aids.
 *
 *  Aids with the same lever arm and the same sigma of it are at one point of the body: the error of
 *  the lever arm is one for all of them.
 *
 *  The error of a reading is e = c + w. w is white, from reading to reading. c is a first-order
 *  Gauss-Markov process in continuous time, whether the aid is read or not. */
#ifndef IMUKIT_AIDING_H
#define IMUKIT_AIDING_H

#include "imukit/status.h"

#include <stddef.h>
#include <stdint.h>

IMK_BEGIN_C

/** What an aid measures; its axes are those of `sigma`. */
typedef enum imk_aid_kind {
    IMK_AID_POSITION = 0, /**< of the end of the lever arm; north, east, down [m] */
    IMK_AID_VELOCITY,     /**< of the end of the lever arm, relative to the Earth; north, east, down
                             [m/s] */
    IMK_AID_HEADING,      /**< azimuth of body x, east of north [rad]; one axis */
    IMK_AID_HEIGHT,       /**< above the ellipsoid, of the end of the lever arm [m]; one axis */
    IMK_AID_ODOMETER, /**< velocity of the end of the lever arm relative to the Earth, along body
                         x, y, z [m/s]: x is read; y and z, if their sigmas are finite, are 0
                         (wheels that neither skid nor leave the ground) */
    IMK_AID_ZERO_VELOCITY, /**< the unit stands; north, east, down [m/s] */
    IMK_AID_KIND_COUNT
} imk_aid_kind;

/** "position", "velocity", "heading", "height", "odometer", "zero velocity"; NULL: no such kind. */
IMK_API const char *imk_aid_kind_name(imk_aid_kind kind);
/** Number of axes: 3 or 1. */
IMK_API size_t imk_aid_axes(imk_aid_kind kind);
/** SI unit of its readings and of sigma: "m", "m/s", "rad". */
IMK_API const char *imk_aid_unit(imk_aid_kind kind);

enum { IMK_AIDS_MAX = 8 };

/** One aid. Start from imk_aid_default(). */
typedef struct imk_aid {
    uint32_t cookie;
    imk_aid_kind kind;
    double sigma[3];            /**< 1 sigma of w; > 0; infinity: this axis is not measured */
    double correlated_sigma[3]; /**< 1 sigma of c; 0: there is none */
    double correlation_time;    /**< of c [s], > 0 if a correlated_sigma is */
    double interval;            /**< from reading to reading [s]; > 0 */
    double from, until;         /**< readings lie in from … until [s]; from is the first one */
    double lever_arm[3];        /**< from the unit to the point that is measured, body axes [m] */
    double lever_arm_sigma[3];  /**< 1 sigma of its constant error [m] */
} imk_aid;

/** One reading per second, from 1 s without end, white, no lever arm; the axes that the kind has
 *  with sigma 1 (SI), the sideways and vertical velocity of an odometer not used. */
IMK_API imk_aid imk_aid_default(imk_aid_kind kind);
/** Check an aid. @return IMK_ERROR_UNINITIALISED, _RANGE, _NOT_FINITE (error.field: the field) */
IMK_API imk_status imk_aid_validate(const imk_aid *aid, imk_error *error);

IMK_END_C
#endif
