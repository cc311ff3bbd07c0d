/* SPDX-License-Identifier: Apache-2.0 */
/* Noise slower than a bench test, for the units of reference_session.h. */
#ifndef IMUKIT_TEST_SLOW_UNITS_H
#define IMUKIT_TEST_SLOW_UNITS_H

#include "reference_session.h"

/* Bias instabilities of 5 deg/h and 30 ug: they overtake the white noise of 0.15 deg/sqrt(h) and
 * 50 ug/sqrt(Hz) after 7 and 6 s, of tests of some 4 minutes. */
static inline void slow_flicker(imk_model *m)
{
    for (int axis = 0; axis < 3; axis++) {
        m->gyro.noise.bias_instability.value[axis] = 5.0 / 3600.0 * session_pi / 180.0;
        m->accel.noise.bias_instability.value[axis] = 30e-6 * session_gravity;
    }
}

/* Besides a random walk that comes to the same over half a minute, and a Gauss-Markov process of a
 * minute. */
static inline void slow_all(imk_model *m)
{
    slow_flicker(m);
    m->gyro.noise.gauss_markov_count = m->accel.noise.gauss_markov_count = 1;
    for (int axis = 0; axis < 3; axis++) {
        m->gyro.noise.random_walk.value[axis] = 1.0 / 3600.0 * session_pi / 180.0;
        m->accel.noise.random_walk.value[axis] = 5e-6 * session_gravity;
        m->gyro.noise.gauss_markov[0].sigma.value[axis] = 5.0 / 3600.0 * session_pi / 180.0;
        m->gyro.noise.gauss_markov[0].correlation_time.value[axis] = 60.0;
        m->accel.noise.gauss_markov[0].sigma.value[axis] = 30e-6 * session_gravity;
        m->accel.noise.gauss_markov[0].correlation_time.value[axis] = 60.0;
    }
}

#endif
