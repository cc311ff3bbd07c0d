/* SPDX-License-Identifier: Apache-2.0 */
/* Navigation states between Earth-fixed and north-east-down axes: with C_en of the place,
 *
 *     r_e = place in Earth-fixed coordinates,   v_e = C_en v_n,   C_eb = C_en C_nb          */
#include "imukit/navigate.h"

imk_navigation_state imk_navigation_state_ned(double time, imk_geodetic place,
                                              imk_vector3 velocity_ned, imk_matrix3 c_nb)
{
    const imk_matrix3 c_en = imk_ned_axes(place.latitude, place.longitude);
    return (imk_navigation_state){.time = time,
                                  .position = imk_ecef_from_geodetic(place),
                                  .velocity = imk_matrix3_apply(c_en, velocity_ned),
                                  .attitude =
                                      imk_quaternion_from_matrix(imk_matrix3_multiply(c_en, c_nb))};
}

void imk_navigation_state_to_ned(const imk_navigation_state *state, imk_geodetic *place,
                                 imk_vector3 *velocity_ned, imk_matrix3 *c_nb)
{
    const imk_geodetic here = imk_geodetic_from_ecef(state->position);
    const imk_matrix3 c_ne = imk_matrix3_transpose(imk_ned_axes(here.latitude, here.longitude));
    if (place != NULL)
        *place = here;
    if (velocity_ned != NULL)
        *velocity_ned = imk_matrix3_apply(c_ne, state->velocity);
    if (c_nb != NULL)
        *c_nb = imk_matrix3_multiply(c_ne, imk_quaternion_to_matrix(state->attitude));
}

/* Nearby positions differ by far less than their size, so their difference is exact. */
imk_vector3 imk_navigation_difference_ned(const imk_navigation_state *a,
                                          const imk_navigation_state *b)
{
    const imk_geodetic place = imk_geodetic_from_ecef(b->position);
    const imk_matrix3 c_ne = imk_matrix3_transpose(imk_ned_axes(place.latitude, place.longitude));
    return imk_matrix3_apply(c_ne, imk_vector3_subtract(a->position, b->position));
}
