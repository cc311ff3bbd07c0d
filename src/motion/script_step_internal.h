/* SPDX-License-Identifier: Apache-2.0 */
/* One step of a motion script as a function of time, in north-east-down axes. */
#ifndef IMUKI_SCRIPT_STEP_INTERNAL_H
#define IMUKI_SCRIPT_STEP_INTERNAL_H

#include "attitude_jet_internal.h"
#include "imukit/motion_script.h"

/* "MS" and the number of the struct's layout: tells a script from uninitialised memory. */
#define IMKI_MOTION_SCRIPT_COOKIE 0x4D530001u

/* Faster is not meant [m/s]. */
#define IMKI_SPEED_LIMIT 1e5

enum { IMKI_STRETCHES_MAX = 3 };

/* How the vehicle goes, and how the body stands in it, between steps. */
typedef struct imki_vehicle {
    double speed, heading, climb;
    imk_quaternion body; /* body to vehicle axes */
} imki_vehicle;

/* Attitude (body to north-east-down) and velocity in north-east-down axes. */
typedef struct imki_local_motion {
    imki_quaternion_jet attitude, velocity;
} imki_local_motion;

/* A part of a step within which its functions are smooth. */
typedef struct imki_stretch {
    double end;     /* from the beginning of the step [s] */
    double spacing; /* longest piece that may be tried [s]; infinite while nothing changes */
    bool even;      /* nothing changes but angles, evenly: the longest piece is good */
} imki_stretch;

/* A step under way. */
typedef struct imki_step_run {
    const imk_motion_step *step;
    imki_vehicle begin, end;
    double duration;
    double gravity;       /* that a banked turn leans against [m/s^2] */
    imki_profile profile; /* of speed, heading, climb angle or rotation */
    imk_vector3 axis;     /* of a pose: the axis and the angle to turn by */
    double angle;
    double growth; /* a swing or coning grows, and dies away, so long */
    int stretch_count;
    imki_stretch stretch[IMKI_STRETCHES_MAX];
} imki_step_run;

/* The vehicle at the beginning of a script. */
imki_vehicle imki_vehicle_start(const imk_motion_script *script);
/* Its motion while no step changes it. */
imki_local_motion imki_vehicle_motion(const imki_vehicle *vehicle);

double imki_step_duration(const imk_motion_step *step, double smoothing);
imki_step_run imki_step_begin(const imk_motion_step *step, double smoothing, imki_vehicle vehicle,
                              double gravity);
/* Motion at a time since the beginning of the step. */
imki_local_motion imki_step_motion(const imki_step_run *run, double time);

/* Check every number of a script that can be assessed by itself. */
imk_status imki_script_check(const imk_motion_script *script, imk_error *error);
/* Fill an error about a step: `field` such as "step.rate", with the number and its limit. */
imk_status imki_step_refuse(imk_error *error, const char *field, size_t index, double value,
                            double limit, const char *expected);

#endif
