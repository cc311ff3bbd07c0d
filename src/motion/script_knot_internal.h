/* SPDX-License-Identifier: Apache-2.0 */
/* Instants between which a piece is interpolated, in Earth-fixed axes. */
#ifndef IMUKI_SCRIPT_KNOT_INTERNAL_H
#define IMUKI_SCRIPT_KNOT_INTERNAL_H

#include "script_step_internal.h"

/* What the axes of a script are. */
typedef struct imki_script_frame {
    bool earth;
    imk_geodetic place; /* of the start */
    imk_vector3 origin; /* of positions: the start, or zero without Earth */
} imki_script_frame;

typedef struct imki_knot {
    double time;
    imk_vector3 position; /* relative to the origin of the frame */
    imk_geodetic place;
    imki_quaternion_jet attitude; /* q_eb, of the same sign as its neighbours' */
    imki_quaternion_jet velocity; /* Earth-fixed */
    double turning;               /* how fast north-east-down turns on the Earth [rad/s] */
    bool moving;
} imki_knot;

imki_script_frame imki_script_frame_of(const imk_motion_script *script);

/* The knot at a time and position with this motion. @param before  the knot before, or NULL */
imki_knot imki_knot_make(const imki_script_frame *frame, double time, imk_vector3 position,
                         const imki_local_motion *motion, const imki_knot *before);

/* Where a body gets that goes from one knot to the next: the integral of the interpolated velocity.
 * Only time and velocity of `last` are used. */
imk_vector3 imki_knot_travel(const imki_knot *first, const imki_knot *last);

/* The piece between two knots. */
imk_trajectory_piece imki_knot_piece(const imki_knot *first, const imki_knot *last);

/* The endless piece of a body at rest. */
imk_trajectory_piece imki_knot_rest(const imki_knot *knot);

/* Whether a piece between two motions in north-east-down axes departs less than the tolerances from
 * what the step says. */
bool imki_piece_is_good(const imki_step_run *run, const imki_local_motion *first, double first_time,
                        const imki_local_motion *last, double last_time);

#endif
