/* SPDX-License-Identifier: Apache-2.0 */
/* A strapdown mechanisation as the textbooks give it, the yardstick of ours: north-east-down axes,
 * latitude, longitude and height, trigonometry in each step [GROVES2013, section 5.4;
 * TITTERTON2004, chapters 3 and 11]. Not for the poles. */
#ifndef IMUKIT_TEXTBOOK_NED_H
#define IMUKIT_TEXTBOOK_NED_H

typedef struct textbook_ned {
    double latitude, longitude, height; /**< [rad], [rad], [m] */
    double velocity[3];                 /**< north, east, down [m/s] */
    double attitude[4];                 /**< q_nb, scalar first */
    int samples; /**< 1: increments as they are; 2: coning and sculling with the last */
    double last_angle[3], last_velocity[3];
} textbook_ned;

/** One step, from increments of angle [rad] and velocity [m/s]. */
void textbook_ned_step(textbook_ned *state, double dt, const double angle[3],
                       const double velocity[3]);

#endif
