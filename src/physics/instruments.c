/* SPDX-License-Identifier: Apache-2.0 */
/* The kinds of instruments there are. */
#include "base/text_internal.h"
#include "imukit/fibre_optic.h"
#include "imukit/free_gyro.h"
#include "imukit/mems_accelerometer.h"
#include "imukit/pendulous_servo.h"
#include "imukit/rate_gyro.h"
#include "imukit/rate_integrating_gyro.h"
#include "imukit/ring_laser.h"
#include "imukit/shell_gyro.h"
#include "imukit/suspended_rotor.h"
#include "imukit/tuned_gyro.h"
#include "imukit/tuning_fork.h"
#include "imukit/vibrating_beam.h"

#include <stdbool.h>

/* In the order of the lecture: spinning mass, optical, vibratory, accelerometers. */
static const imk_instrument *const instruments[] = {&imk_free_gyro_instrument,
                                                    &imk_rate_gyro_instrument,
                                                    &imk_rate_integrating_gyro_instrument,
                                                    &imk_tuned_gyro_instrument,
                                                    &imk_suspended_rotor_instrument,
                                                    &imk_fibre_optic_instrument,
                                                    &imk_ring_laser_instrument,
                                                    &imk_tuning_fork_instrument,
                                                    &imk_shell_gyro_instrument,
                                                    &imk_mems_accelerometer_instrument,
                                                    &imk_pendulous_servo_instrument,
                                                    &imk_vibrating_beam_instrument,
                                                    NULL};
enum { INSTRUMENTS = sizeof instruments / sizeof instruments[0] - 1 };

size_t imk_instrument_count(void)
{
    return INSTRUMENTS;
}

const imk_instrument *imk_instrument_get(size_t index)
{
    return index < INSTRUMENTS ? instruments[index] : NULL;
}

static bool is_separator(char c)
{
    return c == ' ' || c == '-' || c == '_';
}

static bool same_name(const char *a, const char *b)
{
    for (;;) {
        while (is_separator(*a))
            a++;
        while (is_separator(*b))
            b++;
        if (imki_lower(*a) != imki_lower(*b))
            return false;
        if (*a == '\0')
            return true;
        a++;
        b++;
    }
}

const imk_instrument *imk_instrument_find(const char *name)
{
    for (size_t i = 0; name && i < INSTRUMENTS; i++)
        if (same_name(name, instruments[i]->name))
            return instruments[i];
    return NULL;
}
