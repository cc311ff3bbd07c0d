/* SPDX-License-Identifier: Apache-2.0 */
/* A unit at rest that navigates by itself, for the bench of the page: the mechanisation of
 * `imukit navigate` without alignment, aids and prediction, which the page has no room for. The
 * height is held, and position and level at the start are true. */
#include "imukit/navigate.h"
#include "imukit/units.h"

#include <stdlib.h>

#define EXPORT(name) __attribute__((export_name(#name))) name

static double *readings, *track;

/** Room for the rows of a log: three rates [deg/s] and three specific forces [m/s^2] each.
 *  @return NULL when memory is exhausted */
double *EXPORT(reckon_room)(int rows)
{
    free(readings);
    readings = malloc((size_t)rows * 6 * sizeof *readings);
    return readings;
}

static double *report(const imk_strapdown *s, const imk_navigation_state *start, double *at)
{
    double roll, pitch, yaw;
    imk_matrix3 c_nb;
    const imk_vector3 way = imk_navigation_difference_ned(&s->state, start);
    imk_navigation_state_to_ned(&s->state, NULL, NULL, &c_nb);
    imk_matrix3_to_euler(c_nb, &roll, &pitch, &yaw);
    *at++ = s->state.time;
    *at++ = way.v[0];
    *at++ = way.v[1];
    *at++ = yaw / imk_unit_of("deg").scale;
    return at;
}

/** Navigate the rows of reckon_room(), dt [s] apart, from latitude 45 deg, longitude 10 deg and
 *  height 0, level and with a heading [deg].
 *  @param every  rows between two reports
 *  @return time [s], north [m], east [m] and heading [deg] at the start and after each `every`
 *          rows; NULL when memory is exhausted */
double *EXPORT(reckon)(int rows, double dt, double heading, int every)
{
    const double degree = imk_unit_of("deg").scale;
    const imk_geodetic place = {.latitude = 45 * degree, .longitude = 10 * degree};
    const imk_navigation_state start = imk_navigation_state_ned(
        -dt, place, (imk_vector3){{0}}, imk_matrix3_from_euler(0, 0, heading * degree));
    imk_strapdown s = imk_strapdown_start(&start);
    s.hold_height = true;
    free(track);
    track = malloc((size_t)(rows / every + 1) * 4 * sizeof *track);
    if (!track || !readings)
        return NULL;
    double *at = report(&s, &start, track);
    for (int k = 0; k < rows; k++) {
        imk_vector3 angle, velocity;
        for (int i = 0; i < 3; i++) {
            angle.v[i] = readings[6 * k + i] * degree * dt;
            velocity.v[i] = readings[6 * k + 3 + i] * dt;
        }
        imk_strapdown_step(&s, dt, angle, velocity);
        if ((k + 1) % every == 0)
            at = report(&s, &start, at);
    }
    return track;
}
