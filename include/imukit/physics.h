/* SPDX-License-Identifier: Apache-2.0 */
/** @file physics.h
 *  Everything of libimukit-physics: the instruments and their laboratory. Each instrument appears
 *  twice: with its header, and in the list of all instruments. */
#ifndef IMUKIT_PHYSICS_H
#define IMUKIT_PHYSICS_H

#include "imukit/fibre_optic.h"
#include "imukit/free_gyro.h"
#include "imukit/instrument.h"
#include "imukit/laboratory.h"
#include "imukit/mems_accelerometer.h"
#include "imukit/pendulous_servo.h"
#include "imukit/rate_gyro.h"
#include "imukit/rate_integrating_gyro.h"
#include "imukit/ring_laser.h"
#include "imukit/shell_gyro.h"
#include "imukit/spinning_mass.h"
#include "imukit/suspended_rotor.h"
#include "imukit/tuned_gyro.h"
#include "imukit/tuning_fork.h"
#include "imukit/vibrating_beam.h"

/** List of all instruments by name; imk_NAME_instrument is the description. Order: spinning mass,
 *  optical, vibratory, accelerometers. */
#define IMK_INSTRUMENT_LIST(kind)                                                                  \
    kind(free_gyro) kind(rate_gyro) kind(rate_integrating_gyro) kind(tuned_gyro)                   \
        kind(suspended_rotor) kind(fibre_optic) kind(ring_laser) kind(tuning_fork)                 \
            kind(shell_gyro) kind(mems_accelerometer) kind(pendulous_servo) kind(vibrating_beam)

#endif
